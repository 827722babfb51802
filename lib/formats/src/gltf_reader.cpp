#include "pleat/formats/gltf_reader.h"

#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "glb_mesh.h"
#include "glb_pose.h"
#include "gltf_file.h"
#include "pleat/base/file.h"
#include "pleat/base/foreign_file.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

absl::StatusOr<MeshFile> DecodeContainer(std::string_view bytes, const MeshLimits& limits) {
  PLEAT_ASSIGN_OR_RETURN(const GlbContainer glb, GlbContainer::Open(bytes, limits));
  PLEAT_ASSIGN_OR_RETURN(const GlbNodes nodes, GlbNodes::Read(glb));
  PLEAT_ASSIGN_OR_RETURN(GlbMesh mesh, ReadGlbMesh(glb, nodes, true, limits));
  return MeshFile{.topology = mesh.topology,
                  .positions = PlaceGlbMesh(mesh, nodes, {}),
                  .appearance = std::move(mesh.appearance),
                  .notes = std::move(mesh.notes)};
}

}  // namespace

absl::StatusOr<MeshFile> DecodeGlb(std::string_view bytes, const std::string& file,
                                   const MeshLimits& limits) {
  if (bytes.empty()) return absl::InvalidArgumentError(absl::StrCat(file, ": the file is empty"));
  return WithContext(file, DecodeContainer(bytes, limits));
}

absl::StatusOr<std::string> ReadGltfBytes(const std::string& path, const MeshLimits& limits) {
  PLEAT_ASSIGN_OR_RETURN(std::string bytes, ReadFile(path, limits.max_file_bytes));
  const bool is_named_binary = absl::EndsWith(absl::AsciiStrToLower(path), ".glb");
  if (std::string_view(bytes).starts_with("glTF")) return bytes;
  PLEAT_RETURN_IF_ERROR(RefuseForeignBytes(bytes, path));
  if (bytes.empty() || (is_named_binary && !IsGltfText(bytes))) {
    return bytes;
  }
  if (bytes.size() > limits.max_document_bytes) {
    return absl::ResourceExhaustedError(absl::StrCat(
        path, ": ", bytes.size(), " bytes of text; the limit is ", limits.max_document_bytes));
  }
  return WithContext(path, PackGltf(bytes, path, limits));
}

absl::StatusOr<MeshFile> ReadGltf(const std::string& path, const MeshLimits& limits) {
  PLEAT_ASSIGN_OR_RETURN(const std::string bytes, ReadGltfBytes(path, limits));
  return DecodeGlb(bytes, path, limits);
}

}  // namespace pleat
