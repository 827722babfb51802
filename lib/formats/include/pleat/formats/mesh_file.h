// What one mesh file holds.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "pleat/mesh/input_note.h"
#include "pleat/mesh/mesh_limits.h"
#include "pleat/mesh/topology.h"

namespace pleat {

// One frame as its file lists it. Vertex order and count, polygons, texture corners and materials
// are those of the file. Positions hold NaN or infinity when the file does; MeshSequence refuses
// them and names frame and vertex.
struct MeshFile {
  Topology topology;
  Eigen::Matrix3Xf positions;      // 3 x V, in the file's units and axes
  MeshAppearance appearance;       // names are UTF-8
  std::vector<InputNote> notes{};  // what was left out, one for each kind, without the file's name
};

}  // namespace pleat
