// A model file is a header, a table of ten sections that follow each other without gaps, and a
// checksum over everything before it. Reading trusts none of it: the checksum is verified first,
// which finds accidents, but an attacker can compute it. So every section checks its counts against
// the bytes that it has before it allocates, and it must use up all of them. What memory holds in a
// larger form than the file (a whitener, a basis for all vertices) has a limit of its own.
//
// Sections are read in their order because later ones need the counts of earlier ones. Whether all
// parts fit together is decided by CharacterModel::Create alone.
#include "pleat/formats/model_file.h"

#include <array>
#include <utility>

#include "absl/strings/str_cat.h"
#include "detail_section.h"
#include "model_sections.h"
#include "model_versions.h"
#include "pleat/base/bytes.h"
#include "pleat/base/file.h"
#include "pleat/base/sealed_file.h"
#include "pleat/base/sha256.h"
#include "pleat/base/status.h"
#include "pleat/character/train_options.h"
#include "pleat/math/array_io.h"

namespace pleat {
namespace {

constexpr FileKind kModelKind = {"PLEATMDL", kModelFileVersion, 1, "model file"};
constexpr uint32_t kNumSections = 10;
constexpr uint64_t kTableEntryBytes = 24;
constexpr uint64_t kFirstSectionOffset = kFileKindBytes + 4 + kNumSections * kTableEntryBytes;

// The type of a section is its place in this list, counted from 1.
constexpr std::array<const char*, kNumSections> kSectionNames = {
    "info",    "topology",      "appearance", "skeleton", "skin",
    "options", "pose features", "control",    "detail",   "record"};

std::array<std::string, kNumSections> EncodeSections(const CharacterModel::Parts& parts) {
  std::array<ByteWriter, kNumSections> writers;
  WriteInfo(parts, &writers[0]);
  WriteTopology(parts.topology, &writers[1]);
  WriteAppearance(parts.appearance, &writers[2]);
  WriteSkeleton(parts.rig.skeleton, &writers[3]);
  WriteSkin(parts.rig, &writers[4]);
  writers[5].WriteRaw(FormatTrainOptions(parts.options));
  writers[6].Write(static_cast<uint32_t>(parts.feature_reference.size()));
  WriteMatrix(parts.feature_reference, &writers[6]);
  WriteSkinFeatures(parts.skin_features, &writers[6]);
  WriteControl(parts, &writers[7]);
  WriteDetail(parts.detail_model->parameters(), &writers[8]);
  WriteRecord(parts.record, &writers[9]);
  std::array<std::string, kNumSections> sections;
  for (size_t i = 0; i < kNumSections; ++i) sections[i] = writers[i].Release();
  return sections;
}

using Sections = std::array<std::string_view, kNumSections>;

// Checks the table and cuts the file into its sections.
absl::StatusOr<Sections> CutSections(std::string_view content) {
  ByteReader reader(content.substr(kFileKindBytes));
  PLEAT_ASSIGN_OR_RETURN(const uint32_t num_sections, reader.Read<uint32_t>("section count"));
  if (num_sections != kNumSections) {
    return absl::InvalidArgumentError(
        absl::StrCat(num_sections, " sections, expected ", kNumSections));
  }
  Sections sections;
  uint64_t end = kFirstSectionOffset;
  for (uint32_t i = 0; i < kNumSections; ++i) {
    PLEAT_ASSIGN_OR_RETURN(const uint32_t type, reader.Read<uint32_t>("section type"));
    PLEAT_ASSIGN_OR_RETURN(const uint32_t zero, reader.Read<uint32_t>("section table"));
    PLEAT_ASSIGN_OR_RETURN(const uint64_t offset, reader.Read<uint64_t>("section offset"));
    PLEAT_ASSIGN_OR_RETURN(const uint64_t size, reader.Read<uint64_t>("section size"));
    if (type != i + 1 || zero != 0 || offset != end || offset > content.size() ||
        size > content.size() - offset) {
      return absl::DataLossError(absl::StrCat(
          "the table entry of section '", kSectionNames[i], "' (type ", type, ", offset ", offset,
          ", size ", size, ") does not fit the file: it is cut off or corrupt"));
    }
    sections[i] = content.substr(offset, size);
    end = offset + size;
  }
  if (end != content.size()) {
    return absl::DataLossError(
        absl::StrCat(content.size() - end, " bytes too many behind the last section"));
  }
  return sections;
}

// Reads section `index` (counted from 0) with `read(reader)`, which must use all of its bytes.
template <typename Read>
absl::Status ReadSection(const Sections& sections, size_t index, Read&& read) {
  ByteReader reader(sections[index]);
  absl::Status status = read(&reader);
  if (status.ok() && reader.remaining() != 0) {
    status = absl::DataLossError(absl::StrCat(reader.remaining(), " bytes too many"));
  }
  return WithContext(absl::StrCat("section '", kSectionNames[index], "'"), std::move(status));
}

// Moves the value of a StatusOr into `target`.
template <typename T, typename Target>
absl::Status Assign(absl::StatusOr<T> value, Target* target) {
  if (!value.ok()) return value.status();
  *target = *std::move(value);
  return absl::OkStatus();
}

// Checks what CharacterModel::Create is going to allocate beyond what is there already: the basis
// for all vertices, as floats.
absl::Status CheckUnfoldedSize(const CharacterModel::Parts& parts, uint64_t num_components,
                               uint64_t max_bytes) {
  if (!parts.upsampler) return absl::OkStatus();
  const uint64_t num_values = uint64_t{3} * static_cast<uint64_t>(parts.topology.num_vertices());
  if (num_values * (num_components + 1) * sizeof(float) <= max_bytes) return absl::OkStatus();
  return absl::ResourceExhaustedError(
      absl::StrCat("the detail basis of ", parts.topology.num_vertices(), " vertices and ",
                   num_components, " components is over the limit of ", max_bytes, " bytes"));
}

absl::Status ReadMeshSections(const Sections& sections, uint32_t version, const MeshLimits& limits,
                              CharacterModel::Parts* parts) {
  PLEAT_RETURN_IF_ERROR(ReadSection(sections, 0, [&](ByteReader* reader) {
    return ReadInfo(reader, &parts->name, &parts->frame_rate);
  }));
  PLEAT_RETURN_IF_ERROR(ReadSection(sections, 1, [&](ByteReader* reader) {
    return Assign(ReadTopology(reader, limits), &parts->topology);
  }));
  PLEAT_RETURN_IF_ERROR(ReadSection(sections, 2, [&](ByteReader* reader) {
    return Assign(ReadAppearance(reader, parts->topology), &parts->appearance);
  }));
  Skeleton skeleton;
  PLEAT_RETURN_IF_ERROR(ReadSection(
      sections, 3, [&](ByteReader* reader) { return Assign(ReadSkeleton(reader), &skeleton); }));
  return ReadSection(sections, 4, [&](ByteReader* reader) {
    return Assign(ReadSkin(reader, version, skeleton, parts->topology.num_vertices()), &parts->rig);
  });
}

absl::Status ReadLearnedSections(const Sections& sections, uint32_t version,
                                 const MeshLimits& limits, CharacterModel::Parts* parts) {
  const std::string_view options = sections[5];
  PLEAT_ASSIGN_OR_RETURN(parts->options,
                         ParseTrainOptions(absl::string_view(options.data(), options.size())));
  if (version < kFirstWithInfluences) parts->options.influences = kStandardInfluences;
  PLEAT_RETURN_IF_ERROR(ReadSection(sections, 6, [&](ByteReader* reader) -> absl::Status {
    PLEAT_ASSIGN_OR_RETURN(const uint32_t count, reader->Read<uint32_t>("feature count"));
    PLEAT_RETURN_IF_ERROR(
        ReadMatrix(reader, count, 1, "feature reference", &parts->feature_reference));
    if (version < kFirstWithSkinFeatures) return absl::OkStatus();
    return Assign(ReadSkinFeatures(reader, version, parts->rig), &parts->skin_features);
  }));
  PLEAT_RETURN_IF_ERROR(ReadSection(sections, 7, [&](ByteReader* reader) {
    return ReadControl(reader, parts->topology.num_vertices(), &parts->control_vertices,
                       &parts->upsampler);
  }));
  PLEAT_RETURN_IF_ERROR(ReadSection(sections, 8, [&](ByteReader* reader) -> absl::Status {
    PLEAT_ASSIGN_OR_RETURN(DetailModelParameters parameters,
                           ReadDetail(reader, version, limits.max_unfolded_bytes));
    const auto num_components = static_cast<uint64_t>(parameters.basis.num_coefficients);
    PLEAT_RETURN_IF_ERROR(CheckUnfoldedSize(*parts, num_components, limits.max_unfolded_bytes));
    PLEAT_ASSIGN_OR_RETURN(DetailModel model, DetailModel::FromParameters(std::move(parameters)));
    parts->detail_model = std::make_shared<const DetailModel>(std::move(model));
    return absl::OkStatus();
  }));
  return ReadSection(
      sections, 9, [&](ByteReader* reader) { return Assign(ReadRecord(reader), &parts->record); });
}

}  // namespace

std::string EncodeModel(const CharacterModel& model) {
  const std::array<std::string, kNumSections> sections = EncodeSections(model.parts());
  ByteWriter writer;
  WriteFileKind(kModelKind, &writer);
  writer.Write(kNumSections);
  uint64_t offset = kFirstSectionOffset;
  for (uint32_t i = 0; i < kNumSections; ++i) {
    writer.Write(i + 1);
    writer.Write(uint32_t{0});
    writer.Write(offset);
    writer.Write(static_cast<uint64_t>(sections[i].size()));
    offset += sections[i].size();
  }
  for (const std::string& section : sections) writer.WriteRaw(section);
  return SealFile(&writer);
}

absl::StatusOr<std::shared_ptr<const CharacterModel>> DecodeModel(std::string_view bytes,
                                                                  const MeshLimits& limits) {
  PLEAT_ASSIGN_OR_RETURN(const SealedFile file, OpenSealedFile(kModelKind, bytes));
  PLEAT_ASSIGN_OR_RETURN(const Sections sections, CutSections(file.bytes));
  CharacterModel::Parts parts;
  PLEAT_RETURN_IF_ERROR(ReadMeshSections(sections, file.version, limits, &parts));
  PLEAT_RETURN_IF_ERROR(ReadLearnedSections(sections, file.version, limits, &parts));
  return CharacterModel::Create(std::move(parts));
}

absl::StatusOr<std::shared_ptr<const CharacterModel>> ReadModelFile(const std::string& path,
                                                                    const MeshLimits& limits) {
  PLEAT_ASSIGN_OR_RETURN(const std::string bytes, ReadFile(path, limits.max_file_bytes));
  return WithContext(path, DecodeModel(bytes, limits));
}

std::string ModelId(std::string_view bytes) { return ToHex(ComputeSha256(bytes)); }

}  // namespace pleat
