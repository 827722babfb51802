// Writes frames as Wavefront OBJ.
#pragma once

#include <Eigen/Core>
#include <string>

#include "absl/status/status.h"
#include "pleat/mesh/topology.h"

namespace pleat {

// Returns the text of one frame. Numbers are the shortest that read back as the same float32.
// positions: 3 x V.
std::string EncodeObj(const Topology& topology, const Eigen::Ref<const Eigen::Matrix3Xf>& positions,
                      const MeshAppearance& appearance = {});
absl::Status WriteObj(const std::string& path, const Topology& topology,
                      const Eigen::Ref<const Eigen::Matrix3Xf>& positions,
                      const MeshAppearance& appearance = {});

}  // namespace pleat
