// Computes normals of vertices.
#pragma once

#include <Eigen/Core>

namespace pleat {

// Returns the sum of the normals of the triangles around each vertex (3 x V), each twice its
// triangle's area long. A sum is zero where a vertex has no triangle or its triangles cancel;
// callers normalize in the axes and the precision that they need. positions: 3 x V; triangles: 3 x
// F, columns of it.
Eigen::Matrix3Xd SumTriangleNormals(const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
                                    const Eigen::Ref<const Eigen::Matrix3Xi>& triangles);

}  // namespace pleat
