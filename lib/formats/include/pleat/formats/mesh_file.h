// What one mesh file holds, and the limits under which files are read.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "pleat/mesh/topology.h"

namespace pleat {

// Refused above these with kResourceExhausted: the bytes come from outside.
struct MeshFileLimits {
  uint64_t max_file_bytes = uint64_t{8} << 30;  // of any one file
  int64_t max_vertices = 4'000'000;
  int64_t max_faces = 8'000'000;
  int64_t max_frames = 100'000;
  uint64_t max_sequence_bytes = uint64_t{8} << 30;  // T x V x 12: positions of all frames
};

// One frame as its file lists it: vertex order and count, polygons, texture corners and materials
// are those of the file. Positions may hold NaN or infinity when the file does: MeshSequence
// refuses them with frame and vertex.
struct MeshFile {
  Topology topology;
  Eigen::Matrix3Xf positions;  // 3 x V, in the file's units and axes
  MeshAppearance appearance;
};

}  // namespace pleat
