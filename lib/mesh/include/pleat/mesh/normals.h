// Computes normals of vertices.
#pragma once

#include <Eigen/Core>

#include "pleat/mesh/topology.h"

namespace pleat {

// Returns unit normals (3 x V): the area-weighted mean of the faces around each vertex. A normal is
// zero where a vertex has no face or its faces cancel. positions: 3 x V.
Eigen::Matrix3Xd ComputeVertexNormals(const Topology& topology,
                                      const Eigen::Ref<const Eigen::Matrix3Xd>& positions);

}  // namespace pleat
