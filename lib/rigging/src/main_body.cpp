#include "main_body.h"

#include <cmath>
#include <numbers>

#include "pleat/mesh/bounds.h"

namespace pleat {

MainBody FindMainBody(const BodyVolume& volume, const Eigen::Matrix3d& upright_from_input) {
  const BodyShell& shell = volume.body->shell;
  MainBody body{volume.graph.Turned(upright_from_input),
                volume.medial_samples,
                {upright_from_input * shell.positions, shell.triangles},
                {}};
  for (MedialSample& sample : body.medial_samples) {
    sample.position = upright_from_input * sample.position;
  }
  body.bounds = ComputeBounds(body.shell.positions);
  return body;
}

double HorizontalAxisYaw(const BodyShell& shell, const Eigen::Matrix3d& upright_from_shell) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  Eigen::Matrix2d products = Eigen::Matrix2d::Zero();
  double total = 0;
  for (Eigen::Index f = 0; f < shell.triangles.cols(); ++f) {
    Eigen::Matrix<double, 2, 3> corners;
    Eigen::Matrix3d places;
    for (int k = 0; k < 3; ++k) {
      places.col(k) = upright_from_shell * shell.positions.col(shell.triangles(k, f));
      corners.col(k) << places(0, k), places(2, k);
    }
    const double area = (places.col(1) - places.col(0)).cross(places.col(2) - places.col(0)).norm();
    const Eigen::Vector2d corner_sum = corners.rowwise().sum();
    sum += area / 3 * corner_sum;
    // The second moment of a triangle, exactly.
    products += area / 12 * (corners * corners.transpose() + corner_sum * corner_sum.transpose());
    total += area;
  }
  const Eigen::Matrix2d covariance = products / total - sum * sum.transpose() / (total * total);
  // The direction of the larger eigenvalue of a symmetric 2 x 2 matrix.
  const double angle = .5 * std::atan2(2 * covariance(0, 1), covariance(0, 0) - covariance(1, 1));
  return angle > 0 ? std::numbers::pi - angle : -angle;
}

}  // namespace pleat
