#include "split_vertices.h"

#include <bit>
#include <utility>

namespace pleat {
namespace {

uint64_t KeyOf(const Eigen::Vector2f& texcoord) {
  return uint64_t{std::bit_cast<uint32_t>(texcoord.x())} << 32 |
         std::bit_cast<uint32_t>(texcoord.y());
}

// Numbers the copies of each vertex as their texture coordinates come.
class Splitter {
 public:
  explicit Splitter(int num_vertices) {
    for (int v = 0; v < num_vertices; ++v) split_.sources.push_back(v);
    split_.texcoords.assign(num_vertices, Eigen::Vector2f::Zero());
    is_used_.assign(num_vertices, false);
    next_copies_.assign(num_vertices, -1);
  }

  int32_t Corner(int32_t vertex, const Eigen::Vector2f& texcoord) {
    int32_t copy = vertex, last = vertex;
    for (; copy >= 0 && is_used_[copy]; last = copy, copy = next_copies_[copy]) {
      if (KeyOf(split_.texcoords[copy]) == KeyOf(texcoord)) return copy;
    }
    if (copy < 0) {
      copy = static_cast<int32_t>(split_.sources.size());
      split_.sources.push_back(vertex);
      split_.texcoords.push_back(texcoord);
      is_used_.push_back(true);
      next_copies_.push_back(-1);
      next_copies_[last] = copy;
      return copy;
    }
    is_used_[copy] = true;
    split_.texcoords[copy] = texcoord;
    return copy;
  }
  SplitVertices Take() { return std::move(split_); }

 private:
  SplitVertices split_;
  std::vector<int32_t> next_copies_;  // of each, the next copy of its vertex; -1 = none
  std::vector<bool> is_used_;
};

}  // namespace

SplitVertices SplitAtSeams(const Topology& topology, const MeshAppearance& appearance) {
  Splitter splitter(topology.num_vertices());
  const bool has_texcoords = !appearance.corner_texcoords.empty();
  std::vector<int32_t> corners = topology.corner_vertices();
  for (size_t c = 0; has_texcoords && c < corners.size(); ++c) {
    const int32_t index = appearance.corner_texcoords[c];
    corners[c] = splitter.Corner(corners[c],
                                 index < 0 ? Eigen::Vector2f(0, 0) : appearance.texcoords[index]);
  }
  SplitVertices split = splitter.Take();
  if (!has_texcoords) split.texcoords.clear();
  split.triangles.resize(3, topology.num_triangles());
  Eigen::Index t = 0;
  for (int f = 0; f < topology.num_faces(); ++f) {
    const int begin = topology.face_start(f), size = static_cast<int>(topology.face(f).size());
    for (int c = 1; c + 1 < size; ++c) {
      split.triangles.col(t++) << corners[begin], corners[begin + c], corners[begin + c + 1];
      if (!appearance.face_materials.empty()) {
        split.triangle_materials.push_back(appearance.face_materials[f]);
      }
    }
  }
  return split;
}

}  // namespace pleat
