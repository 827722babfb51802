#include "pleat/mesh/normals.h"

#include <Eigen/Geometry>
#include <cassert>

namespace pleat {

Eigen::Matrix3Xd ComputeVertexNormals(const Topology& topology,
                                      const Eigen::Ref<const Eigen::Matrix3Xd>& positions) {
  assert(positions.cols() == topology.num_vertices());
  Eigen::Matrix3Xd normals = Eigen::Matrix3Xd::Zero(3, positions.cols());
  const Eigen::Matrix3Xi& triangles = topology.triangles();
  for (Eigen::Index i = 0; i < triangles.cols(); ++i) {
    const int a = triangles(0, i), b = triangles(1, i), c = triangles(2, i);
    const Eigen::Vector3d ab = positions.col(b) - positions.col(a);
    const Eigen::Vector3d ac = positions.col(c) - positions.col(a);
    // The cross product is as long as twice the area, which gives the weighting for free.
    const Eigen::Vector3d twice_area = ab.cross(ac);
    for (const int v : {a, b, c}) normals.col(v) += twice_area;
  }
  for (Eigen::Index v = 0; v < normals.cols(); ++v) {
    const double length = normals.col(v).norm();
    if (length > 0) normals.col(v) /= length;
  }
  return normals;
}

}  // namespace pleat
