// The properties of an Alembic object and their samples.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "alembic_archive.h"
#include "ogawa_reader.h"

namespace pleat {

enum class AlembicKind : uint8_t { kCompound, kScalar, kArray };

// In the order of the numbers in the file.
enum class AlembicType : uint8_t {
  kBool,
  kUint8,
  kInt8,
  kUint16,
  kInt16,
  kUint32,
  kInt32,
  kUint64,
  kInt64,
  kFloat16,
  kFloat32,
  kFloat64,
  kString,
  kWstring,
};
inline constexpr int kNumAlembicTypes = 14;

// The header of one property. The views live as long as the bytes of the archive.
struct AlembicProperty {
  std::string_view name;
  std::string_view metadata;
  AlembicKind kind = AlembicKind::kCompound;
  OgawaRef group;  // of its samples, or of its properties

  // Not for compounds.
  AlembicType type = AlembicType::kBool;
  int extent = 1;  // values per element
  uint32_t num_samples = 0;
  // Samples before the first change equal sample 0, those after the last equal the last; both 0
  // when all are equal.
  uint32_t first_changed = 0, last_changed = 0;
  uint32_t time_sampling = 0;

  bool changes() const { return num_samples > 1 && last_changed > 0; }
  bool Is(AlembicKind k, AlembicType t, int e) const {
    return kind == k && type == t && extent == e;
  }
};

// The properties of a compound, in the order of the file.
class AlembicProperties {
 public:
  // group: that of the compound. kDataLoss or kInvalidArgument names what is wrong.
  static absl::StatusOr<AlembicProperties> Read(OgawaRef group, AlembicArchive* archive);

  const std::vector<AlembicProperty>& all() const { return all_; }
  // Null when there is none of that name.
  const AlembicProperty* Find(std::string_view name) const;
  // The properties of the compound of that name; none when it is not there.
  absl::StatusOr<AlembicProperties> Compound(std::string_view name, AlembicArchive* archive) const;

 private:
  std::vector<AlembicProperty> all_;
};

// Where sample `sample` of a scalar or an array lies; beyond the last, that of the last. Equal
// references are equal samples. There must be a sample; kDataLoss when it is not in the file.
absl::StatusOr<OgawaRef> FindSample(const AlembicProperty& property, uint32_t sample,
                                    const AlembicArchive& archive);

// The values of a sample behind its key. kDataLoss when they are no whole number of elements.
absl::StatusOr<std::string_view> ReadValues(const AlembicProperty& property, OgawaRef sample,
                                            AlembicArchive* archive);

// Both in one.
absl::StatusOr<std::string_view> ReadSampleValues(const AlembicProperty& property, uint32_t sample,
                                                  AlembicArchive* archive);

}  // namespace pleat
