#include "alembic_builder.h"

#include <algorithm>
#include <utility>

#include "murmur_hash.h"

namespace pleat {
namespace {

constexpr int32_t kWrittenLayout = 0, kWrittenLibrary = 10800;  // as library version 1.8 writes
constexpr uint32_t kSamplingBit = 0x100, kChangesBit = 0x200, kSameSizeBit = 0x400;
constexpr uint32_t kConstantBit = 0x800;

std::string_view BytesOf(const std::array<uint64_t, 2>& digest) {
  return {reinterpret_cast<const char*>(digest.data()), sizeof(digest)};
}

void WriteSized(uint32_t value, uint32_t hint, ByteWriter* writer) {
  if (hint == 0) {
    writer->Write(static_cast<uint8_t>(value));
  } else if (hint == 1) {
    writer->Write(static_cast<uint16_t>(value));
  } else {
    writer->Write(value);
  }
}

// The size that all numbers of a header fit into.
uint32_t HintFor(std::initializer_list<size_t> numbers) {
  const size_t most = std::max(numbers);
  return most < 256 ? 0 : most < 65536 ? 1 : 2;
}

uint32_t SampleBytes(const PropertyToWrite& property) {
  constexpr uint32_t kBytes[kNumAlembicTypes] = {1, 1, 1, 2, 2, 4, 4, 8, 8, 2, 4, 8, 1, 4};
  return kBytes[static_cast<size_t>(property.type)] * static_cast<uint32_t>(property.extent);
}

// Which samples differ from sample 0 first, and from the one before last; 0 and 0 when none does.
std::pair<uint32_t, uint32_t> FindChanges(const std::vector<WrittenSample>& samples) {
  uint32_t first = 0, last = 0;
  for (uint32_t i = 1; i < samples.size(); ++i) {
    if (samples[i].ref == samples[i - 1].ref) continue;
    if (first == 0) first = i;
    last = i;
  }
  return {first, last};
}

void WriteNameAndMetadata(const std::string& name, const std::string& metadata, uint32_t index,
                          uint32_t hint, ByteWriter* writer) {
  WriteSized(static_cast<uint32_t>(name.size()), hint, writer);
  writer->WriteRaw(name);
  if (index != kTextFollows) return;
  WriteSized(static_cast<uint32_t>(metadata.size()), hint, writer);
  writer->WriteRaw(metadata);
}

}  // namespace

WrittenSample AlembicBuilder::AddSample(std::string_view values) {
  WrittenSample sample;
  sample.num_bytes = values.size();
  sample.key = MurmurHash3(values);
  const auto [begin, end] = samples_.equal_range(sample.key);
  for (auto known = begin; known != end; ++known) {
    const WrittenSample& other = known->second;
    const size_t num_bytes = sizeof(sample.key) + values.size();
    if (other.num_bytes == values.size() &&
        writer_.ContentAt(other.ref, num_bytes).substr(sizeof(sample.key)) == values) {
      return other;
    }
  }
  sample.ref = writer_.AddData(values, BytesOf(sample.key));
  samples_.emplace(sample.key, sample);
  return sample;
}

uint32_t AlembicBuilder::AddTimeSampling(AlembicTimeSampling sampling) {
  const auto known = std::ranges::find(samplings_, sampling);
  const auto number = static_cast<uint32_t>(known - samplings_.begin());
  if (known == samplings_.end()) {
    samplings_.push_back(std::move(sampling));
    max_samples_.push_back(0);
  }
  return number;
}

uint32_t AlembicBuilder::IndexOf(const std::string& metadata) {
  const auto known = std::ranges::find(metadata_, metadata);
  const auto index = static_cast<uint32_t>(known - metadata_.begin());
  if (known != metadata_.end()) return index;
  if (metadata.size() > 255 || index >= kTextFollows) return kTextFollows;
  metadata_.push_back(metadata);
  return index;
}

AlembicBuilder::Written AlembicBuilder::AddSamples(const PropertyToWrite& property,
                                                   ByteWriter* headers) {
  const auto num_samples = static_cast<uint32_t>(property.samples.size());
  const auto [first, last] = FindChanges(property.samples);
  const uint32_t index = IndexOf(property.metadata);
  const uint32_t hint = HintFor(
      {property.name.size(), property.metadata.size(), num_samples, property.time_sampling});
  const bool has_changes = last > 0 && (first != 1 || last != num_samples - 1);
  const auto has_bytes = [&](uint64_t bytes) {
    return std::ranges::all_of(property.samples,
                               [&](const auto& sample) { return sample.num_bytes == bytes; });
  };
  const bool is_array = property.kind == AlembicKind::kArray;
  uint32_t info = is_array ? 2 | static_cast<uint32_t>(has_bytes(SampleBytes(property))) : 1;
  info |= hint << 2 | static_cast<uint32_t>(property.type) << 4;
  info |= static_cast<uint32_t>(property.extent) << 12 | index << 20;
  if (property.time_sampling != 0) info |= kSamplingBit;
  if (has_changes) info |= kChangesBit;
  if (last == 0) info |= kConstantBit;
  if (num_samples == 0 || has_bytes(property.samples[0].num_bytes)) info |= kSameSizeBit;
  headers->Write(info);
  WriteSized(num_samples, hint, headers);
  if (has_changes) {
    WriteSized(first, hint, headers);
    WriteSized(last, hint, headers);
  }
  if (property.time_sampling != 0) WriteSized(property.time_sampling, hint, headers);
  WriteNameAndMetadata(property.name, property.metadata, index, hint, headers);

  uint32_t& most = max_samples_[property.time_sampling];
  most = std::max(most, last == 0 ? std::min(num_samples, 1u) : num_samples);
  std::vector<OgawaRef> children;
  std::string keys;
  for (uint32_t i = 0; i < num_samples; ++i) {
    if (i > 0 && (last == 0 || i < first || i > last)) continue;
    children.push_back(property.samples[i].ref);
    if (is_array) children.push_back({OgawaRef::kDataBit});  // one dimension
    keys.append(BytesOf(property.samples[i].key));
  }
  return {writer_.AddGroup(children), MurmurHash3(keys)};
}

AlembicBuilder::Written AlembicBuilder::AddProperty(const PropertyToWrite& property,
                                                    ByteWriter* headers) {
  if (property.kind != AlembicKind::kCompound) return AddSamples(property, headers);
  const uint32_t index = IndexOf(property.metadata);
  const uint32_t hint = HintFor({property.name.size(), property.metadata.size()});
  headers->Write(hint << 2 | index << 20);
  WriteNameAndMetadata(property.name, property.metadata, index, hint, headers);
  return AddCompound(property.properties);
}

AlembicBuilder::Written AlembicBuilder::AddCompound(
    const std::vector<PropertyToWrite>& properties) {
  if (properties.empty()) return {};
  std::vector<OgawaRef> children;
  ByteWriter headers;
  std::string digests;
  for (const PropertyToWrite& property : properties) {
    const Written written = AddProperty(property, &headers);
    children.push_back(written.ref);
    digests.append(BytesOf(written.digest));
  }
  children.push_back(writer_.AddData(headers.bytes()));
  return {writer_.AddGroup(children), MurmurHash3(headers.bytes() + digests)};
}

AlembicBuilder::Written AlembicBuilder::AddObject(const ObjectToWrite& object) {
  const Written properties = AddCompound(object.properties);
  std::vector<OgawaRef> children = {properties.ref};
  ByteWriter headers;
  std::string digests;
  for (const ObjectToWrite& child : object.children) {
    const Written written = AddObject(child);
    children.push_back(written.ref);
    digests.append(BytesOf(written.digest));
    headers.WriteString(child.name);
    const uint32_t index = IndexOf(child.metadata);
    headers.Write(static_cast<uint8_t>(index));
    if (index == kTextFollows) headers.WriteString(child.metadata);
  }
  const Digest children_digest = object.children.empty() ? Digest{} : MurmurHash3(digests);
  headers.WriteRaw(BytesOf(properties.digest));
  headers.WriteRaw(BytesOf(children_digest));
  children.push_back(writer_.AddData(headers.bytes()));
  return {writer_.AddGroup(children), MurmurHash3(object.name + headers.bytes())};
}

std::string AlembicBuilder::Finish(const std::vector<ObjectToWrite>& objects,
                                   const std::string& metadata) {
  const auto version = [this](int32_t number) {
    return writer_.AddData({reinterpret_cast<const char*>(&number), sizeof(number)});
  };
  std::vector<OgawaRef> root = {version(kWrittenLayout), version(kWrittenLibrary)};
  root.push_back(AddObject({.name = "ABC", .children = objects}).ref);
  root.push_back(writer_.AddData(metadata));
  ByteWriter samplings;
  for (size_t i = 0; i < samplings_.size(); ++i) {
    WriteTimeSampling(samplings_[i], max_samples_[i], &samplings);
  }
  root.push_back(writer_.AddData(samplings.bytes()));
  ByteWriter indexed;
  for (size_t i = 1; i < metadata_.size(); ++i) {
    indexed.Write(static_cast<uint8_t>(metadata_[i].size()));
    indexed.WriteRaw(metadata_[i]);
  }
  root.push_back(writer_.AddData(indexed.bytes()));
  return writer_.Finish(writer_.AddGroup(root));
}

}  // namespace pleat
