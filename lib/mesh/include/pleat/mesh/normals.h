// Computes normals of vertices.
#pragma once

#include <Eigen/Core>

#include "pleat/mesh/vertex_rows.h"

namespace pleat {

// Returns the sum of the normals of the triangles around each vertex (3 x V), each twice its
// triangle's area long. A sum is zero where a vertex has no triangle or its triangles cancel;
// callers normalize in the axes and the precision that they need. positions: 3 x V; triangles: 3 x
// F, columns of it.
Eigen::Matrix3Xd SumTriangleNormals(const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
                                    const Eigen::Ref<const Eigen::Matrix3Xi>& triangles);

// Writes the unit normal of every vertex of one frame, weighted by area as above and computed in
// single precision, as a renderer wants it. The normal is zero where the sum has no length.
// positions, normals: num_vertices rows each, which must not overlap; triangles: 3 x F. Allocates
// nothing.
void ComputeVertexNormals(const VertexRows& positions, int num_vertices,
                          const Eigen::Matrix3Xi& triangles, const VertexRows& normals);

}  // namespace pleat
