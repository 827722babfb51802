// A mesh whose vertices have one texture coordinate each, as renderers want it.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "pleat/mesh/topology.h"

namespace pleat {

struct SplitVertices {
  // Of each vertex, the vertex of the topology whose position it has. The first are those of the
  // topology in their order, the others are repetitions.
  std::vector<int32_t> sources;
  std::vector<Eigen::Vector2f> texcoords;  // as many; empty when the mesh has none
  // 3 x triangles, of the topology's triangles in their order.
  Eigen::Matrix3Xi triangles;
  std::vector<int32_t> triangle_materials;  // -1 = none; empty when no face has one
};

// Texture coordinates that are equal count as one. Corners without any have 0 0.
SplitVertices SplitAtSeams(const Topology& topology, const MeshAppearance& appearance);

}  // namespace pleat
