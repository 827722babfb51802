// Rigid motions, x -> R x + t, and their least-squares fit to point pairs.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "absl/status/statusor.h"

namespace pleat {

struct RigidTransform {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  Eigen::Vector3d operator*(const Eigen::Vector3d& point) const {
    return rotation * point + translation;
  }
  RigidTransform operator*(const RigidTransform& other) const {
    return {rotation * other.rotation, rotation * other.translation + translation};
  }
  RigidTransform Inverse() const {
    return {rotation.transpose(), -(rotation.transpose() * translation)};
  }
};

// Returns the rigid motion that minimizes sum_i weights_i |R source_i + t - target_i|^2 (Kabsch
// 1976; Procrustes without scale). source, target: 3 x N; weights: N, or empty for ones. The error
// is kInvalidArgument when sizes differ or the weights do not sum to a positive number.
absl::StatusOr<RigidTransform> FitRigidTransform(const Eigen::Ref<const Eigen::Matrix3Xd>& source,
                                                 const Eigen::Ref<const Eigen::Matrix3Xd>& target,
                                                 const Eigen::VectorXd& weights = {});

}  // namespace pleat
