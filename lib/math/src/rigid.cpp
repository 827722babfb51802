#include "pleat/math/rigid.h"

#include "absl/strings/str_cat.h"
#include "pleat/math/rotations.h"

namespace pleat {

absl::StatusOr<RigidTransform> FitRigidTransform(const Eigen::Ref<const Eigen::Matrix3Xd>& source,
                                                 const Eigen::Ref<const Eigen::Matrix3Xd>& target,
                                                 const Eigen::VectorXd& weights) {
  const Eigen::Index count = source.cols();
  if (target.cols() != count || (weights.size() != 0 && weights.size() != count)) {
    return absl::InvalidArgumentError(absl::StrCat("rigid fit of ", count, " source points to ",
                                                   target.cols(), " target points with ",
                                                   weights.size(), " weights: counts must agree"));
  }
  const Eigen::VectorXd w = weights.size() ? weights : Eigen::VectorXd::Ones(count);
  const double total = w.sum();
  if (!(total > 0)) return absl::InvalidArgumentError("rigid fit needs a positive total weight");
  const Eigen::Vector3d source_mean = source * w / total;
  const Eigen::Vector3d target_mean = target * w / total;
  // The best translation maps the weighted mean to the weighted mean, whatever the rotation; what
  // is left is a Procrustes problem of centered points.
  const Eigen::Matrix3d covariance = (target.colwise() - target_mean) * w.asDiagonal() *
                                     (source.colwise() - source_mean).transpose();
  RigidTransform fit;
  fit.rotation = NearestRotation(covariance);
  fit.translation = target_mean - fit.rotation * source_mean;
  return fit;
}

}  // namespace pleat
