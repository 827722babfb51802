#include "pleat/formats/obj_writer.h"

#include <charconv>

#include "absl/strings/str_cat.h"
#include "pleat/base/file.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

template <typename T>
void AppendNumber(T value, std::string* text) {
  char buffer[32];
  const std::to_chars_result result = std::to_chars(buffer, buffer + sizeof(buffer), value);
  text->append(buffer, result.ptr);
}

void AppendCorner(int32_t vertex, int32_t texcoord, std::string* text) {
  text->push_back(' ');
  AppendNumber(vertex + int64_t{1}, text);
  if (texcoord < 0) return;
  text->push_back('/');
  AppendNumber(texcoord + int64_t{1}, text);
}

// Returns everything that follows the vertices.
std::string EncodeFaces(const Topology& topology, const MeshAppearance& appearance) {
  std::string text;
  for (const Eigen::Vector2f& texcoord : appearance.texcoords) {
    text.append("vt ");
    AppendNumber(texcoord.x(), &text);
    text.push_back(' ');
    AppendNumber(texcoord.y(), &text);
    text.push_back('\n');
  }
  int32_t material = -1;
  for (int f = 0; f < topology.num_faces(); ++f) {
    if (!appearance.face_materials.empty() && appearance.face_materials[f] != material) {
      material = appearance.face_materials[f];
      // OBJ cannot go back to "no material", so an empty name stands for it.
      absl::StrAppend(&text, "usemtl ", material < 0 ? "" : appearance.material_names[material],
                      "\n");
    }
    text.push_back('f');
    const std::span<const int32_t> corners = topology.face(f);
    for (size_t c = 0; c < corners.size(); ++c) {
      const size_t corner = static_cast<size_t>(topology.face_start(f)) + c;
      AppendCorner(corners[c],
                   appearance.corner_texcoords.empty() ? -1 : appearance.corner_texcoords[corner],
                   &text);
    }
    text.push_back('\n');
  }
  return text;
}

std::string EncodeVertices(const Eigen::Ref<const Eigen::Matrix3Xf>& positions,
                           const MeshAppearance& appearance) {
  std::string text;
  text.reserve(static_cast<size_t>(positions.cols()) * 40);
  if (!appearance.material_library.empty()) {
    absl::StrAppend(&text, "mtllib ", appearance.material_library, "\n");
  }
  for (Eigen::Index v = 0; v < positions.cols(); ++v) {
    text.push_back('v');
    for (int axis = 0; axis < 3; ++axis) {
      text.push_back(' ');
      AppendNumber(positions(axis, v), &text);
    }
    text.push_back('\n');
  }
  return text;
}

}  // namespace

std::string EncodeObj(const Topology& topology, const Eigen::Ref<const Eigen::Matrix3Xf>& positions,
                      const MeshAppearance& appearance) {
  return EncodeVertices(positions, appearance) + EncodeFaces(topology, appearance);
}

absl::Status WriteObj(const std::string& path, const Topology& topology,
                      const Eigen::Ref<const Eigen::Matrix3Xf>& positions,
                      const MeshAppearance& appearance) {
  return WriteFile(path, EncodeObj(topology, positions, appearance));
}

}  // namespace pleat
