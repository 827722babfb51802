#include "pleat/math/rotations.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace pleat {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

Matrix3d CrossMatrix(const Vector3d& v) {
  Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

Quaterniond QuaternionFromExponentialMap(const Vector3d& w) {
  const double half = 0.5 * w.norm();
  // sin(h)/(2h) by its series near zero: the next term is below 1e-17 there.
  const double scale = half < 1e-4 ? 0.5 - half * half / 12 : 0.5 * std::sin(half) / half;
  return Quaterniond(std::cos(half), scale * w.x(), scale * w.y(), scale * w.z());
}

Vector3d ExponentialMapFromQuaternion(const Quaterniond& rotation) {
  Quaterniond q = rotation.normalized();
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  // atan2 keeps full precision at both ends, where acos(w) or asin(sine) would lose half of the
  // digits.
  const double sine = q.vec().norm();
  if (sine < 1e-8) return 2 * q.vec();
  return (2 * std::atan2(sine, q.w()) / sine) * q.vec();
}

Vector3d UnwrapExponentialMap(const Vector3d& w, const Vector3d& reference) {
  const double angle = w.norm();
  // After a whole turn there is no axis but that of the reference. All candidates lie on one line,
  // and the nearest one is where the line comes closest to `reference`.
  const bool has_axis = angle >= 1e-9;
  if (!has_axis && reference.norm() < std::numbers::pi) return w;
  const Vector3d axis = has_axis ? (w / angle).eval() : reference.normalized();
  const double turns = std::round((axis.dot(reference) - angle) / (2 * std::numbers::pi));
  return w + 2 * std::numbers::pi * turns * axis;
}

Vector3d EulerXyzFromRotation(const Matrix3d& rotation) {
  const double sine_b = std::clamp(rotation(0, 2), -1.0, 1.0);
  const double b = std::asin(sine_b);
  if (std::abs(sine_b) > 1 - 1e-10) {  // gimbal lock: only a +- c is known
    return {std::atan2(rotation(2, 1), rotation(1, 1)), b, 0};
  }
  return {std::atan2(-rotation(1, 2), rotation(2, 2)), b,
          std::atan2(-rotation(0, 1), rotation(0, 0))};
}

Matrix3d RotationFromEulerXyz(const Vector3d& angles) {
  return (Eigen::AngleAxisd(angles.x(), Vector3d::UnitX()) *
          Eigen::AngleAxisd(angles.y(), Vector3d::UnitY()) *
          Eigen::AngleAxisd(angles.z(), Vector3d::UnitZ()))
      .toRotationMatrix();
}

Matrix3d NearestRotation(const Matrix3d& matrix) {
  const Eigen::JacobiSVD<Matrix3d> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  // Where U V^T is a reflection, the direction of the least singular value is turned around: Eigen
  // sorts singular values by falling size, and this costs least.
  Vector3d signs(1, 1, (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1);
  return svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
}

}  // namespace pleat
