#include "pleat/mesh/mesh_sections.h"

#include <span>
#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"
#include "pleat/base/utf8.h"
#include "pleat/math/array_io.h"

namespace pleat {

void WriteName(std::string_view name, ByteWriter* writer) {
  writer->WriteString(Utf8Prefix(name, kMaxNameBytes));
}

absl::StatusOr<std::string> ReadName(ByteReader* reader, absl::string_view what) {
  return reader->ReadString(kMaxNameBytes, what);
}

void WriteMaterialNames(const MeshAppearance& appearance, ByteWriter* writer) {
  WriteName(appearance.material_library, writer);
  for (const std::string& name : appearance.material_names) WriteName(name, writer);
}

absl::Status ReadMaterialNames(ByteReader* reader, uint32_t num_materials,
                               MeshAppearance* appearance) {
  PLEAT_ASSIGN_OR_RETURN(appearance->material_library, ReadName(reader, "material library"));
  PLEAT_RETURN_IF_ERROR(reader->Require(num_materials, sizeof(uint32_t), "material names"));
  appearance->material_names.clear();
  for (uint32_t m = 0; m < num_materials; ++m) {
    PLEAT_ASSIGN_OR_RETURN(std::string name, ReadName(reader, "material name"));
    appearance->material_names.push_back(std::move(name));
  }
  return absl::OkStatus();
}

uint32_t AppearanceFlags(const MeshAppearance& appearance) {
  return (appearance.corner_texcoords.empty() ? 0 : kHasCornerTexcoords) |
         (appearance.face_materials.empty() ? 0 : kHasFaceMaterials);
}

absl::Status CheckAppearanceFlags(uint32_t flags, uint32_t num_corners, uint32_t num_faces) {
  const uint32_t known_flags =
      (num_corners > 0 ? kHasCornerTexcoords : 0) | (num_faces > 0 ? kHasFaceMaterials : 0);
  if ((flags & ~known_flags) == 0) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat("unknown flags ", flags));
}

void WriteAppearanceLists(const MeshAppearance& appearance, ByteWriter* writer) {
  for (const Eigen::Vector2f& texcoord : appearance.texcoords) WriteMatrix(texcoord, writer);
  writer->WriteArray(std::span(appearance.corner_texcoords));
  writer->WriteArray(std::span(appearance.face_materials));
}

absl::Status ReadAppearanceLists(ByteReader* reader, uint32_t num_texcoords, uint32_t flags,
                                 const Topology& topology, MeshAppearance* appearance) {
  std::vector<float> coordinates;
  PLEAT_RETURN_IF_ERROR(
      ReadVector(reader, uint64_t{2} * num_texcoords, "texture coordinates", &coordinates));
  appearance->texcoords.clear();
  appearance->texcoords.reserve(num_texcoords);
  for (size_t i = 0; i < coordinates.size(); i += 2) {
    appearance->texcoords.emplace_back(coordinates[i], coordinates[i + 1]);
  }
  if (flags & kHasCornerTexcoords) {
    PLEAT_RETURN_IF_ERROR(ReadVector(reader, static_cast<uint64_t>(topology.num_corners()),
                                     "corner texture coordinates", &appearance->corner_texcoords));
  }
  if (flags & kHasFaceMaterials) {
    PLEAT_RETURN_IF_ERROR(ReadVector(reader, static_cast<uint64_t>(topology.num_faces()),
                                     "face materials", &appearance->face_materials));
  }
  return absl::OkStatus();
}

void WriteFaces(const Topology& topology, ByteWriter* writer) {
  for (int f = 0; f < topology.num_faces(); ++f) {
    writer->Write(static_cast<int32_t>(topology.face(f).size()));
  }
  writer->WriteArray(std::span(topology.corner_vertices()));
}

absl::StatusOr<Topology> ReadFaces(ByteReader* reader, uint32_t num_vertices, uint32_t num_faces,
                                   uint32_t num_corners) {
  std::vector<int32_t> face_sizes, corner_vertices;
  PLEAT_RETURN_IF_ERROR(ReadVector(reader, num_faces, "face sizes", &face_sizes));
  PLEAT_RETURN_IF_ERROR(ReadVector(reader, num_corners, "corner vertices", &corner_vertices));
  return Topology::Create(static_cast<int>(num_vertices), std::move(corner_vertices),
                          std::move(face_sizes));
}

absl::StatusOr<FrameRate> MakeFrameRate(uint32_t numerator, uint32_t denominator) {
  constexpr uint32_t kMaxRate = 0x7fffffff;
  if (numerator == 0 || denominator == 0 || numerator > kMaxRate || denominator > kMaxRate) {
    return absl::InvalidArgumentError(
        absl::StrCat("the frame rate ", numerator, "/", denominator, " is out of range"));
  }
  return FrameRate{static_cast<int32_t>(numerator), static_cast<int32_t>(denominator)};
}

}  // namespace pleat
