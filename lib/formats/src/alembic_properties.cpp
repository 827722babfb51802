#include "alembic_properties.h"

#include <algorithm>
#include <array>

#include "absl/strings/str_cat.h"
#include "pleat/base/bytes.h"
#include "pleat/base/status.h"
#include "pleat/base/utf8.h"

namespace pleat {
namespace {

constexpr size_t kKeyBytes = 16;  // the hash before the values of a sample

// The bits of a header (docs/formats/alembic.md).
constexpr uint32_t kHasSampling = 0x100, kHasChanges = 0x200, kIsConstant = 0x800;
constexpr uint32_t Kind(uint32_t info) { return info & 3; }
constexpr uint32_t SizeHint(uint32_t info) { return (info >> 2) & 3; }
constexpr uint32_t Type(uint32_t info) { return (info >> 4) & 15; }
constexpr uint32_t Extent(uint32_t info) { return (info >> 12) & 255; }
constexpr uint32_t MetadataIndex(uint32_t info) { return (info >> 20) & 255; }

// Bytes of one value; strings end with a zero each.
size_t TypeBytes(AlembicType type) {
  constexpr std::array<size_t, kNumAlembicTypes> kBytes = {1, 1, 1, 2, 2, 4, 4,
                                                           8, 8, 2, 4, 8, 1, 4};
  return kBytes[static_cast<size_t>(type)];
}

absl::StatusOr<uint32_t> ReadSized(uint32_t hint, absl::string_view what, ByteReader* reader) {
  switch (hint) {
    case 0:
      return reader->Read<uint8_t>(what);
    case 1:
      return reader->Read<uint16_t>(what);
    case 2:
      return reader->Read<uint32_t>(what);
    default:
      return absl::InvalidArgumentError(absl::StrCat(what, " has an unknown size"));
  }
}

// The samples of a property that is no compound.
absl::Status ReadSampling(uint32_t info, ByteReader* reader, AlembicProperty* property) {
  if (Type(info) >= kNumAlembicTypes) {
    return absl::InvalidArgumentError(absl::StrCat("a property has the unknown type ", Type(info)));
  }
  property->type = static_cast<AlembicType>(Type(info));
  property->extent = static_cast<int>(Extent(info));
  const uint32_t hint = SizeHint(info);
  PLEAT_ASSIGN_OR_RETURN(property->num_samples, ReadSized(hint, "a number of samples", reader));
  if ((info & kHasChanges) != 0) {
    PLEAT_ASSIGN_OR_RETURN(property->first_changed, ReadSized(hint, "the first change", reader));
    PLEAT_ASSIGN_OR_RETURN(property->last_changed, ReadSized(hint, "the last change", reader));
    if (property->first_changed > property->last_changed) {
      return absl::InvalidArgumentError(absl::StrCat("a property changes first in sample ",
                                                     property->first_changed, " and last in ",
                                                     property->last_changed));
    }
  } else if ((info & kIsConstant) == 0 && property->num_samples > 1) {
    property->first_changed = 1;
    property->last_changed = property->num_samples - 1;
  }
  if ((info & kHasSampling) != 0) {
    PLEAT_ASSIGN_OR_RETURN(property->time_sampling, ReadSized(hint, "a time sampling", reader));
  }
  return absl::OkStatus();
}

absl::StatusOr<AlembicProperty> ReadPropertyHeader(const AlembicArchive& archive,
                                                   ByteReader* reader) {
  AlembicProperty property;
  PLEAT_ASSIGN_OR_RETURN(const uint32_t info, reader->Read<uint32_t>("the header of a property"));
  constexpr AlembicKind kKinds[] = {AlembicKind::kCompound, AlembicKind::kScalar,
                                    AlembicKind::kArray, AlembicKind::kArray};
  property.kind = kKinds[Kind(info)];
  if (property.kind != AlembicKind::kCompound) {
    PLEAT_RETURN_IF_ERROR(ReadSampling(info, reader, &property));
  }
  const uint32_t hint = SizeHint(info);
  PLEAT_ASSIGN_OR_RETURN(const uint32_t name_bytes, ReadSized(hint, "a property's name", reader));
  PLEAT_ASSIGN_OR_RETURN(property.name, reader->ReadRaw(name_bytes, "a property's name"));
  if (MetadataIndex(info) != kTextFollows) {
    PLEAT_ASSIGN_OR_RETURN(property.metadata, archive.IndexedMetadata(MetadataIndex(info)));
    return property;
  }
  PLEAT_ASSIGN_OR_RETURN(const uint32_t bytes, ReadSized(hint, "a property's metadata", reader));
  PLEAT_ASSIGN_OR_RETURN(property.metadata, reader->ReadRaw(bytes, "a property's metadata"));
  return property;
}

}  // namespace

absl::StatusOr<AlembicProperties> AlembicProperties::Read(OgawaRef group, AlembicArchive* archive) {
  PLEAT_ASSIGN_OR_RETURN(const AlembicArchive::Block block, archive->ReadBlock(group));
  AlembicProperties properties;
  ByteReader reader(block.headers);
  while (reader.remaining() > 0) {
    PLEAT_ASSIGN_OR_RETURN(AlembicProperty property, ReadPropertyHeader(*archive, &reader));
    const size_t place = properties.all_.size();
    if (place + 1 >= block.group.size()) {
      return absl::DataLossError(absl::StrCat("the property '", EscapeControls(property.name),
                                              "' has a header but no content"));
    }
    property.group = block.group.child(place);
    properties.all_.push_back(property);
  }
  return properties;
}

const AlembicProperty* AlembicProperties::Find(std::string_view name) const {
  const auto found = std::ranges::find(all_, name, &AlembicProperty::name);
  return found == all_.end() ? nullptr : &*found;
}

absl::StatusOr<AlembicProperties> AlembicProperties::Compound(std::string_view name,
                                                              AlembicArchive* archive) const {
  const AlembicProperty* compound = Find(name);
  if (compound == nullptr || compound->kind != AlembicKind::kCompound) return AlembicProperties();
  return Read(compound->group, archive);
}

absl::StatusOr<OgawaRef> FindSample(const AlembicProperty& property, uint32_t sample,
                                    const AlembicArchive& archive) {
  PLEAT_ASSIGN_OR_RETURN(const OgawaGroup group, archive.Group(property.group));
  uint64_t stored = 0;
  if (property.last_changed > 0 && sample >= property.first_changed) {
    stored = uint64_t{std::min(sample, property.last_changed)} - property.first_changed + 1;
  }
  // Behind the elements of an array are its dimensions.
  const uint64_t place = property.kind == AlembicKind::kArray ? 2 * stored : stored;
  if (place >= group.size()) {
    return absl::DataLossError(absl::StrCat("sample ", sample, " of the property '",
                                            EscapeControls(property.name),
                                            "' is not in the file, which is damaged"));
  }
  return group.child(place);
}

absl::StatusOr<std::string_view> ReadValues(const AlembicProperty& property, OgawaRef sample,
                                            AlembicArchive* archive) {
  PLEAT_ASSIGN_OR_RETURN(const std::string_view bytes, archive->ReadSample(sample));
  if (bytes.empty()) return bytes;
  const size_t element = TypeBytes(property.type) * static_cast<size_t>(property.extent);
  if (bytes.size() < kKeyBytes || element == 0 || (bytes.size() - kKeyBytes) % element != 0) {
    return absl::DataLossError(absl::StrCat(
        "a sample of the property '", EscapeControls(property.name), "' has ", bytes.size(),
        " bytes, which are not ", kKeyBytes, " and a whole number of ", element));
  }
  return bytes.substr(kKeyBytes);
}

absl::StatusOr<std::string_view> ReadSampleValues(const AlembicProperty& property, uint32_t sample,
                                                  AlembicArchive* archive) {
  PLEAT_ASSIGN_OR_RETURN(const OgawaRef ref, FindSample(property, sample, *archive));
  return ReadValues(property, ref, archive);
}

}  // namespace pleat
