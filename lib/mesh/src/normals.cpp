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

void ComputeVertexNormals(const VertexRows& positions, int num_vertices,
                          const Eigen::Matrix3Xi& triangles, const VertexRows& normals) {
  using Row = Eigen::Map<Eigen::Vector3f>;
  for (int v = 0; v < num_vertices; ++v) Row(normals.row(v)).setZero();
  for (Eigen::Index f = 0; f < triangles.cols(); ++f) {
    const int* corners = triangles.data() + 3 * f;
    const Row a(positions.row(corners[0]));
    const Eigen::Vector3f twice_area =
        (Row(positions.row(corners[1])) - a).cross(Row(positions.row(corners[2])) - a);
    for (int c = 0; c < 3; ++c) Row(normals.row(corners[c])) += twice_area;
  }
  for (int v = 0; v < num_vertices; ++v) {
    Row normal(normals.row(v));
    const float length = normal.norm();
    // Below this the direction is rounding; a person's vertex has some 1e-5 square meters.
    constexpr float kNoLength = 1e-20f;
    if (length > kNoLength) {
      normal /= length;
    } else {
      normal.setZero();
    }
  }
}

}  // namespace pleat
