// The mesh of a file that holds positions alone: a point cache or an array.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/mesh/mesh_sequence.h"
#include "sequence_inputs.h"

namespace pleat {

// Joins `frames` (at least one, all of the same number of vertices) with the mesh beside the file
// `path` (see ReadSequence), and says which mesh that is and whether its shape is that of frame 0.
absl::StatusOr<MeshSequence> WithMeshBeside(const std::string& path,
                                            std::vector<Eigen::Matrix3Xf> frames,
                                            FrameRate frame_rate, const InputReading& reading);

}  // namespace pleat
