#include "pleat/math/rigid.h"

#include "pleat/base/random.h"
#include "pleat/math/rotations.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

Eigen::Matrix3Xd RandomPoints(int count, uint64_t seed) {
  Random random(seed);
  Eigen::Matrix3Xd points(3, count);
  for (double& entry : points.reshaped()) entry = random.Normal();
  return points;
}

const RigidTransform kMotion{QuaternionFromExponentialMap({0.4, -1.2, 2.0}).toRotationMatrix(),
                             {3, -1, 0.5}};

TEST(RigidTest, ComposesAndInverts) {
  const RigidTransform other{QuaternionFromExponentialMap({1, 0, 0.3}).toRotationMatrix(),
                             {0, 2, 0}};
  const Eigen::Vector3d point(0.1, 0.2, 0.3);
  EXPECT_TRUE(((kMotion * other) * point).isApprox(kMotion * (other * point)));
  EXPECT_TRUE((kMotion.Inverse() * (kMotion * point)).isApprox(point));
}

TEST(RigidTest, FitRecoversAnExactMotion) {
  const Eigen::Matrix3Xd source = RandomPoints(20, 1);
  const Eigen::Matrix3Xd target = (kMotion.rotation * source).colwise() + kMotion.translation;
  PLEAT_ASSERT_OK_AND_ASSIGN(const RigidTransform fit, FitRigidTransform(source, target));
  EXPECT_LT((fit.rotation - kMotion.rotation).norm(), 1e-12);
  EXPECT_LT((fit.translation - kMotion.translation).norm(), 1e-12);
}

TEST(RigidTest, PointsOfWeightZeroDoNotCount) {
  const Eigen::Matrix3Xd source = RandomPoints(20, 2);
  Eigen::Matrix3Xd target = (kMotion.rotation * source).colwise() + kMotion.translation;
  target.col(4) += Eigen::Vector3d(100, 0, 0);
  Eigen::VectorXd weights = Eigen::VectorXd::Constant(20, 0.5);
  weights[4] = 0;
  PLEAT_ASSERT_OK_AND_ASSIGN(const RigidTransform fit, FitRigidTransform(source, target, weights));
  EXPECT_LT((fit.rotation - kMotion.rotation).norm(), 1e-12);
}

TEST(RigidTest, NoSmallMotionFitsBetter) {
  const Eigen::Matrix3Xd source = RandomPoints(30, 3);
  Eigen::Matrix3Xd target = (kMotion.rotation * source).colwise() + kMotion.translation;
  target += 0.3 * RandomPoints(30, 4);
  PLEAT_ASSERT_OK_AND_ASSIGN(const RigidTransform fit, FitRigidTransform(source, target));
  const auto energy = [&](const RigidTransform& motion) {
    return (((motion.rotation * source).colwise() + motion.translation) - target).squaredNorm();
  };
  for (int i = 0; i < 3; ++i) {
    for (const double step : {-1e-3, 1e-3}) {
      RigidTransform other = fit;
      other.rotation =
          fit.rotation *
          QuaternionFromExponentialMap(step * Eigen::Vector3d::Unit(i)).toRotationMatrix();
      EXPECT_GT(energy(other), energy(fit));
      other = fit;
      other.translation[i] += step;
      EXPECT_GT(energy(other), energy(fit));
    }
  }
}

TEST(RigidTest, BadCountsAndWeightsAreRefused) {
  const Eigen::Matrix3Xd points = RandomPoints(5, 5);
  EXPECT_FALSE(FitRigidTransform(points, points.leftCols(4)).ok());
  EXPECT_FALSE(FitRigidTransform(points, points, Eigen::VectorXd::Ones(3)).ok());
  EXPECT_FALSE(FitRigidTransform(points, points, Eigen::VectorXd::Zero(5)).ok());
}

}  // namespace
}  // namespace pleat
