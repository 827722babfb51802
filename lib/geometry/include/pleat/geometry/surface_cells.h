// A surface cut into few cells of about one size.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "pleat/mesh/topology.h"

namespace pleat {

struct SurfaceCells {
  std::vector<int> centers;  // vertex indices, all different
  // Pairs of cells that touch, as places in `centers`; the smaller first, ascending.
  std::vector<std::array<int, 2>> neighbors;
};

// Spreads at most `count` centers over the vertices of `positions` (3 x V, meters): each is the
// vertex farthest from those before, beginning with vertex 0 (farthest-point sampling). A vertex
// belongs to the center nearest along the edges of the mesh, so cells do not touch across a gap of
// air. Deterministic; costs O(count V).
SurfaceCells MakeSurfaceCells(const Topology& topology, const Eigen::Matrix3Xd& positions,
                              int count);

}  // namespace pleat
