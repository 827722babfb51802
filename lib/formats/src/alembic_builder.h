// Puts Alembic archives together: objects and properties as plain values become bytes.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "alembic_properties.h"
#include "alembic_time.h"
#include "ogawa_writer.h"
#include "pleat/base/bytes.h"

namespace pleat {

// A sample that is in the file: equal ones share their place.
struct WrittenSample {
  OgawaRef ref;
  uint64_t num_bytes = 0;  // of its values
  std::array<uint64_t, 2> key = {};
};

struct PropertyToWrite {
  std::string name;
  std::string metadata{};
  AlembicKind kind = AlembicKind::kCompound;
  // Not for compounds: what a sample holds, and all samples.
  AlembicType type = AlembicType::kBool;
  int extent = 1;
  uint32_t time_sampling = 0;
  std::vector<WrittenSample> samples{};
  // For compounds only.
  std::vector<PropertyToWrite> properties{};
};

struct ObjectToWrite {
  std::string name;
  std::string metadata{};
  std::vector<PropertyToWrite> properties{};
  std::vector<ObjectToWrite> children{};
};

class AlembicBuilder {
 public:
  // Makes room for an archive of that many bytes.
  void Reserve(size_t num_bytes) { writer_.Reserve(num_bytes); }

  // The values of one sample, as they lie in memory. Values that were added before are not written
  // again.
  WrittenSample AddSample(std::string_view values);
  template <Scalar T>
  WrittenSample AddSample(std::span<const T> values) {
    return AddSample(
        std::string_view(reinterpret_cast<const char*>(values.data()), values.size_bytes()));
  }

  // The number of the sampling, for properties. Number 0 is there already: one second, from zero.
  uint32_t AddTimeSampling(AlembicTimeSampling sampling);

  // The whole archive with `objects` at its top. The builder is empty afterwards.
  std::string Finish(const std::vector<ObjectToWrite>& objects, const std::string& metadata);

 private:
  using Digest = std::array<uint64_t, 2>;
  struct Written {
    OgawaRef ref;
    Digest digest = {};
  };

  Written AddObject(const ObjectToWrite& object);
  Written AddProperty(const PropertyToWrite& property, ByteWriter* headers);
  Written AddSamples(const PropertyToWrite& property, ByteWriter* headers);
  Written AddCompound(const std::vector<PropertyToWrite>& properties);
  // Its index, 255 when the text has to be written in place.
  uint32_t IndexOf(const std::string& metadata);

  OgawaWriter writer_;
  std::multimap<Digest, WrittenSample> samples_;
  std::vector<AlembicTimeSampling> samplings_ = {{}};
  std::vector<uint32_t> max_samples_ = {0};
  std::vector<std::string> metadata_ = {""};
};

}  // namespace pleat
