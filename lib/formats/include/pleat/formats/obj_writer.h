// Writing frames as Wavefront OBJ.
#pragma once

#include <Eigen/Core>
#include <string>

#include "absl/status/status.h"
#include "pleat/base/progress.h"
#include "pleat/mesh/mesh_sequence.h"
#include "pleat/mesh/topology.h"

namespace pleat {

// The text of one frame; numbers are the shortest that read back to the same float32.
// positions: 3 x V.
std::string EncodeObj(const Topology& topology, const Eigen::Ref<const Eigen::Matrix3Xf>& positions,
                      const MeshAppearance& appearance = {});
absl::Status WriteObj(const std::string& path, const Topology& topology,
                      const Eigen::Ref<const Eigen::Matrix3Xf>& positions,
                      const MeshAppearance& appearance = {});

// Writes frame_0000.obj, frame_0001.obj, ... into `folder` (made when missing).
absl::Status WriteObjSequence(const std::string& folder, const MeshSequence& sequence,
                              const Progress& progress = {});

}  // namespace pleat
