#include "compressed_format.h"

#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/base/sha256.h"
#include "pleat/base/status.h"
#include "pleat/mesh/mesh_sections.h"

namespace pleat {
namespace {

constexpr uint32_t kMaxMaterials = 1 << 20;
constexpr uint32_t kHasOrigin = 4;  // beside the flags of the appearance

uint32_t FirstBytes(const Sha256Digest& digest) {
  uint32_t result;
  std::memcpy(&result, digest.data(), sizeof(result));
  return result;
}

bool IsOrigin(const Eigen::Vector3d& origin_m) {
  return (origin_m.array().abs() <= std::numeric_limits<float>::max()).all();
}

bool IsStep(double step) { return step > 0 && step < 1e12; }

// Returns the number of materials.
absl::StatusOr<uint32_t> ReadCounts(ByteReader* reader, const MeshLimits& limits,
                                    CompressedHeader* header) {
  uint32_t counts[8];
  PLEAT_RETURN_IF_ERROR(reader->ReadArray(std::span<uint32_t>(counts), "counts"));
  header->num_vertices = counts[0];
  header->num_faces = counts[1];
  header->num_corners = counts[2];
  header->num_frames = counts[3];
  header->num_texcoords = counts[6];
  PLEAT_RETURN_IF_ERROR(CheckCounts({.num_vertices = header->num_vertices,
                                     .num_faces = header->num_faces,
                                     .num_frames = header->num_frames},
                                    limits));
  if (header->num_corners > 8 * limits.max_faces || header->num_texcoords > 4 * limits.max_faces ||
      counts[7] > kMaxMaterials) {
    return absl::ResourceExhaustedError(
        absl::StrCat(header->num_corners, " corners, ", header->num_texcoords,
                     " texture coordinates and ", counts[7], " materials are over the limits"));
  }
  if (header->num_vertices == 0 || header->num_frames == 0 ||
      header->num_corners < uint64_t{3} * header->num_faces) {
    return absl::InvalidArgumentError("a count is out of range");
  }
  PLEAT_ASSIGN_OR_RETURN(header->frame_rate, MakeFrameRate(counts[4], counts[5]));
  return counts[7];
}

absl::Status ReadQuantization(ByteReader* reader, CompressedHeader* header) {
  float steps[4];
  double grid[5];
  PLEAT_ASSIGN_OR_RETURN(const uint8_t kind, reader->Read<uint8_t>("kind of residuals"));
  PLEAT_RETURN_IF_ERROR(reader->ReadArray(std::span<float>(steps), "steps"));
  for (const float step : steps) {
    if (!IsStep(step)) return absl::InvalidArgumentError("a quantization step is out of range");
  }
  header->steps = {steps[0], steps[1], steps[2], steps[3]};
  if (kind > static_cast<uint8_t>(ResidualKind::kGrid)) {
    return absl::InvalidArgumentError(absl::StrCat("residuals of the unknown kind ", kind));
  }
  header->grid.kind = static_cast<ResidualKind>(kind);
  if (header->grid.kind == ResidualKind::kNone) return absl::OkStatus();
  PLEAT_RETURN_IF_ERROR(reader->ReadArray(std::span<double>(grid), "residual grid"));
  header->grid.step_m = grid[0];
  header->grid.bound_m = grid[1];
  header->grid.origin_m << grid[2], grid[3], grid[4];
  if (!IsStep(grid[0]) || !(grid[1] >= 0 && grid[1] < 1e12) ||
      !(header->grid.origin_m.array().abs() < 1e12).all()) {
    return absl::InvalidArgumentError("the residual grid is out of range");
  }
  return absl::OkStatus();
}

}  // namespace

uint32_t ShortChecksum(std::string_view bytes) { return FirstBytes(ComputeSha256(bytes)); }

uint32_t FramesChecksum(const std::vector<Eigen::Matrix3Xf>& frames) {
  Sha256 hash;
  for (const Eigen::Matrix3Xf& frame : frames) {
    hash.Update({reinterpret_cast<const char*>(frame.data()),
                 static_cast<size_t>(frame.size()) * sizeof(float)});
  }
  return FirstBytes(hash.Finish());
}

void WriteSection(SectionKind kind, std::string_view payload, ByteWriter* writer) {
  writer->Write(static_cast<uint8_t>(kind));
  writer->Write(static_cast<uint32_t>(payload.size()));
  writer->Write(ShortChecksum(payload));
  writer->WriteRaw(payload);
}

std::string EncodeHeader(const CompressedHeader& header) {
  ByteWriter writer;
  for (const uint32_t count :
       {header.num_vertices, header.num_faces, header.num_corners, header.num_frames,
        static_cast<uint32_t>(header.frame_rate.numerator),
        static_cast<uint32_t>(header.frame_rate.denominator), header.num_texcoords,
        static_cast<uint32_t>(header.materials.material_names.size())}) {
    writer.Write(count);
  }
  const bool has_origin = !header.origin_m.isZero(0);
  writer.Write(static_cast<uint8_t>(header.appearance_flags | (has_origin ? kHasOrigin : 0)));
  writer.Write(static_cast<uint8_t>(header.grid.kind));
  for (const float step : {header.steps.field_m, header.steps.rest_m, header.steps.rotation,
                           header.steps.translation_m}) {
    writer.Write(step);
  }
  if (header.grid.kind != ResidualKind::kNone) {
    writer.Write(header.grid.step_m);
    writer.Write(header.grid.bound_m);
    for (int c = 0; c < 3; ++c) writer.Write(header.grid.origin_m[c]);
  }
  writer.Write(static_cast<uint32_t>(header.segment_frames.size()));
  for (const uint32_t count : header.segment_frames) writer.Write(static_cast<uint16_t>(count));
  WriteName(header.name, &writer);
  WriteMaterialNames(header.materials, &writer);
  for (int c = 0; has_origin && c < 3; ++c) writer.Write(header.origin_m[c]);
  return writer.Release();
}

absl::StatusOr<std::vector<Section>> ReadSections(std::string_view bytes) {
  ByteReader reader(bytes);
  PLEAT_ASSIGN_OR_RETURN(const uint32_t version, ReadFileKind(kCompressedKind, &reader));
  std::vector<Section> sections;
  do {
    PLEAT_ASSIGN_OR_RETURN(const uint8_t kind, reader.Read<uint8_t>("section"));
    PLEAT_ASSIGN_OR_RETURN(const uint32_t size, reader.Read<uint32_t>("section size"));
    PLEAT_ASSIGN_OR_RETURN(const uint32_t checksum, reader.Read<uint32_t>("section checksum"));
    PLEAT_ASSIGN_OR_RETURN(const std::string_view payload, reader.ReadRaw(size, "section"));
    if (kind < static_cast<uint8_t>(SectionKind::kHeader) ||
        kind > static_cast<uint8_t>(version == 1 ? SectionKind::kEnd : SectionKind::kFaceList)) {
      return absl::DataLossError(absl::StrCat("section ", sections.size(), " is of no known kind"));
    }
    if (ShortChecksum(payload) != checksum) {
      return absl::DataLossError(
          absl::StrCat("section ", sections.size(), " is damaged: its checksum does not agree"));
    }
    sections.push_back({static_cast<SectionKind>(kind), payload});
  } while (sections.back().kind != SectionKind::kEnd);
  if (reader.remaining() != 0) {
    return absl::DataLossError(absl::StrCat(reader.remaining(), " bytes too many at the end"));
  }
  return sections;
}

absl::StatusOr<CompressedHeader> DecodeHeader(std::string_view payload, const MeshLimits& limits) {
  CompressedHeader header;
  ByteReader reader(payload);
  PLEAT_ASSIGN_OR_RETURN(const uint32_t num_materials, ReadCounts(&reader, limits, &header));
  PLEAT_ASSIGN_OR_RETURN(const uint8_t flags, reader.Read<uint8_t>("flags"));
  header.appearance_flags = flags & ~kHasOrigin;
  PLEAT_RETURN_IF_ERROR(
      CheckAppearanceFlags(header.appearance_flags, header.num_corners, header.num_faces));
  PLEAT_RETURN_IF_ERROR(ReadQuantization(&reader, &header));
  PLEAT_ASSIGN_OR_RETURN(const uint32_t num_segments, reader.Read<uint32_t>("segments"));
  PLEAT_RETURN_IF_ERROR(reader.Require(num_segments, 2, "segments"));
  uint64_t num_frames = 0;
  for (uint32_t s = 0; s < num_segments; ++s) {
    PLEAT_ASSIGN_OR_RETURN(const uint16_t count, reader.Read<uint16_t>("segment"));
    if (count == 0 || count > kMaxSegmentFrames) {
      return absl::InvalidArgumentError(absl::StrCat("segment ", s, " has ", count, " frames"));
    }
    header.segment_frames.push_back(count);
    num_frames += count;
  }
  if (num_frames != header.num_frames) {
    return absl::InvalidArgumentError(absl::StrCat("the segments have ", num_frames,
                                                   " frames, the header says ", header.num_frames));
  }
  PLEAT_ASSIGN_OR_RETURN(header.name, ReadName(&reader, "name"));
  PLEAT_RETURN_IF_ERROR(ReadMaterialNames(&reader, num_materials, &header.materials));
  if ((flags & kHasOrigin) != 0) {
    PLEAT_RETURN_IF_ERROR(reader.ReadArray(std::span(header.origin_m.data(), size_t{3}), "origin"));
    if (!IsOrigin(header.origin_m)) return absl::InvalidArgumentError("the origin is out of range");
  }
  if (reader.remaining() != 0) return absl::DataLossError("the header is too long");
  return header;
}

}  // namespace pleat
