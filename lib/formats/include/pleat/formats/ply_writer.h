// Writing frames as Stanford PLY (binary little-endian).
#pragma once

#include <Eigen/Core>
#include <string>

#include "absl/status/status.h"
#include "pleat/mesh/topology.h"

namespace pleat {

// float32 x, y, z; polygons as vertex_indices; texture coordinates, when there are any, as the list
// "texcoord" of u, v per corner (empty for a face with a corner that has none). Materials have no
// place in PLY. positions: 3 x V.
std::string EncodePly(const Topology& topology, const Eigen::Ref<const Eigen::Matrix3Xf>& positions,
                      const MeshAppearance& appearance = {});
absl::Status WritePly(const std::string& path, const Topology& topology,
                      const Eigen::Ref<const Eigen::Matrix3Xf>& positions,
                      const MeshAppearance& appearance = {});

}  // namespace pleat
