#include "sequence_inputs.h"

#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"
#include "pleat/base/utf8.h"
#include "pleat/formats/gltf_reader.h"
#include "pleat/formats/obj_reader.h"
#include "pleat/formats/ply_reader.h"

namespace pleat {

std::string LowerExtension(const std::filesystem::path& path) {
  return absl::AsciiStrToLower(path.extension().string());
}

bool IsMeshFile(const std::filesystem::path& path) {
  const std::string extension = LowerExtension(path);
  return extension == ".obj" || extension == ".ply" || extension == ".drc";
}

bool IsGltfFile(const std::filesystem::path& path) {
  const std::string extension = LowerExtension(path);
  return extension == ".glb" || extension == ".gltf";
}

bool IsArrayFile(const std::filesystem::path& path) {
  const std::string extension = LowerExtension(path);
  return extension == ".npz" || extension == ".npy";
}

std::string DisplayName(const std::filesystem::path& path) {
  return EscapeControls(path.filename().string());
}

absl::StatusOr<MeshFile> ReadMesh(const std::string& path, const ReadSequenceOptions& options) {
  if (IsGltfFile(path)) return ReadGltf(path, options.limits);
  if (LowerExtension(path) != ".drc") {
    return LowerExtension(path) == ".ply" ? ReadPly(path, options.limits)
                                          : ReadObj(path, options.limits);
  }
  if (options.read_draco) return options.read_draco(path);
  return absl::InvalidArgumentError(
      absl::StrCat("'", path, "' is a Draco file, which is not read here"));
}

absl::StatusOr<MeshSequence> CreateSequence(MeshFile mesh, std::vector<Eigen::Matrix3Xf> frames,
                                            MeshSequenceOptions options, const std::string& input) {
  options.appearance = std::move(mesh.appearance);
  options.name = NameToUtf8(options.name);
  return WithContext(
      input, MeshSequence::Create(std::move(mesh.topology), std::move(frames), std::move(options)));
}

}  // namespace pleat
