// Writes frames as Stanford PLY (binary, little-endian).
#pragma once

#include <Eigen/Core>
#include <string>

#include "absl/status/status.h"
#include "pleat/mesh/topology.h"

namespace pleat {

// Returns the bytes of one frame: x, y, z as float32 and polygons as the list vertex_indices.
// Texture coordinates, if there are any, are the list "texcoord" with u, v per corner, which is
// empty for a face with a corner that has none. Materials have no place in PLY. positions: 3 x V.
std::string EncodePly(const Topology& topology, const Eigen::Ref<const Eigen::Matrix3Xf>& positions,
                      const MeshAppearance& appearance = {});
absl::Status WritePly(const std::string& path, const Topology& topology,
                      const Eigen::Ref<const Eigen::Matrix3Xf>& positions,
                      const MeshAppearance& appearance = {});

}  // namespace pleat
