#include "pleat/mesh/normals.h"

#include <Eigen/Geometry>

namespace pleat {

Eigen::Matrix3Xd SumTriangleNormals(const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
                                    const Eigen::Ref<const Eigen::Matrix3Xi>& triangles) {
  Eigen::Matrix3Xd normals = Eigen::Matrix3Xd::Zero(3, positions.cols());
  for (Eigen::Index f = 0; f < triangles.cols(); ++f) {
    const Eigen::Vector3d a = positions.col(triangles(0, f));
    // The cross product is as long as twice the area, which gives the weighting for free.
    const Eigen::Vector3d twice_area =
        (positions.col(triangles(1, f)) - a).cross(positions.col(triangles(2, f)) - a);
    for (int c = 0; c < 3; ++c) normals.col(triangles(c, f)) += twice_area;
  }
  return normals;
}

}  // namespace pleat
