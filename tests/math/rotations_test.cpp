#include "pleat/math/rotations.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <numbers>

#include "pleat/base/random.h"

namespace pleat {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kPi = std::numbers::pi;

Vector3d RandomVector(Random& random, double length) {
  const Vector3d v(random.Normal(), random.Normal(), random.Normal());
  return v.normalized() * length;
}

TEST(RotationsTest, CrossMatrixIsTheCrossProduct) {
  const Vector3d a(1, -2, 3), b(0.5, 4, -1);
  EXPECT_TRUE((CrossMatrix(a) * b).isApprox(a.cross(b)));
}

TEST(RotationsTest, ExponentialMapRoundTripsAtAllAngles) {
  Random random(1);
  for (const double angle : {0.0, 1e-12, 1e-9, 1e-5, 2e-4, 0.1, 1.0, 3.0, kPi - 1e-6}) {
    const Vector3d w = RandomVector(random, angle);
    const Matrix3d rotation = QuaternionFromExponentialMap(w).toRotationMatrix();
    EXPECT_LT((rotation * rotation.transpose() - Matrix3d::Identity()).norm(), 1e-14);
    EXPECT_NEAR(rotation.determinant(), 1, 1e-14);
    EXPECT_LT((ExponentialMapFromQuaternion(Quaterniond(rotation)) - w).norm(), 1e-9 + 1e-9 * angle)
        << angle;
    EXPECT_LT((ExponentialMapFromQuaternion(QuaternionFromExponentialMap(w)) - w).norm(), 1e-12);
  }
  EXPECT_TRUE(QuaternionFromExponentialMap({0, kPi / 2, 0})
                  .toRotationMatrix()
                  .isApprox(Eigen::AngleAxisd(kPi / 2, Vector3d::UnitY()).toRotationMatrix()));
}

TEST(RotationsTest, HalfTurnsKeepTheirAxis) {
  for (const Vector3d& axis : {Vector3d(1, 0, 0), Vector3d(0, 1, 0), Vector3d(0, 0, 1),
                               Vector3d(1, -2, 0.5).normalized()}) {
    const Vector3d w = ExponentialMapFromQuaternion(QuaternionFromExponentialMap(kPi * axis));
    EXPECT_NEAR(w.norm(), kPi, 1e-7);
    EXPECT_NEAR(std::abs(w.normalized().dot(axis)), 1, 1e-7);
  }
}

TEST(RotationsTest, QuaternionSignDoesNotMatter) {
  const Quaterniond q = QuaternionFromExponentialMap({0.3, -1, 2});
  const Quaterniond opposite(-q.w(), -q.x(), -q.y(), -q.z());
  EXPECT_LT((ExponentialMapFromQuaternion(q) - ExponentialMapFromQuaternion(opposite)).norm(),
            1e-14);
}

TEST(RotationsTest, UnwrapIsTheNearestBranchOfTheSameRotation) {
  Random random(2);
  for (int i = 0; i < 200; ++i) {
    const Vector3d w = RandomVector(random, random.Uniform(0.01, kPi));
    const Vector3d reference = RandomVector(random, random.Uniform(0, 10));
    const Vector3d unwrapped = UnwrapExponentialMap(w, reference);
    EXPECT_LT((QuaternionFromExponentialMap(unwrapped).toRotationMatrix() -
               QuaternionFromExponentialMap(w).toRotationMatrix())
                  .norm(),
              1e-9);
    for (int k = -3; k <= 3; ++k) {
      const Vector3d other = w + 2 * kPi * k * w.normalized();
      EXPECT_LE((unwrapped - reference).norm(), (other - reference).norm() + 1e-9);
    }
  }
}

TEST(RotationsTest, AWholeTurnHasTheAxisOfTheReference) {
  const Eigen::Vector3d axis = Eigen::Vector3d(1, 2, -2) / 3;
  const Eigen::Vector3d none = Eigen::Vector3d::Zero();
  const Eigen::Vector3d whole = UnwrapExponentialMap(none, 6.1 * axis);
  EXPECT_LT((whole - 2 * std::numbers::pi * axis).norm(), 1e-12);
  EXPECT_EQ(UnwrapExponentialMap(none, .1 * axis), none);
  EXPECT_EQ(UnwrapExponentialMap(none, none), none);
}

TEST(RotationsTest, UnwrapChainsASpinWithoutJumps) {
  Vector3d previous(0, 0.01, 0);
  for (double angle = 0.01; angle < 20; angle += 0.2) {
    const Vector3d w = ExponentialMapFromQuaternion(QuaternionFromExponentialMap({0, angle, 0}));
    previous = UnwrapExponentialMap(w, previous);
    EXPECT_NEAR(previous.y(), angle, 1e-9);
  }
}

TEST(RotationsTest, EulerAnglesRoundTrip) {
  Random random(4);
  for (int i = 0; i < 200; ++i) {
    const Vector3d angles(random.Uniform(-kPi, kPi), random.Uniform(-1.57, 1.57),
                          random.Uniform(-kPi, kPi));
    EXPECT_LT((EulerXyzFromRotation(RotationFromEulerXyz(angles)) - angles).norm(), 1e-9);
  }
  // Order: R = Rx Ry Rz.
  const Matrix3d x = RotationFromEulerXyz({0.3, 0, 0}), y = RotationFromEulerXyz({0, 0.4, 0}),
                 z = RotationFromEulerXyz({0, 0, 0.5});
  EXPECT_TRUE(RotationFromEulerXyz({0.3, 0.4, 0.5}).isApprox(x * y * z));
}

TEST(RotationsTest, EulerAnglesAtGimbalLockGiveTheSameRotation) {
  for (const double b : {kPi / 2, -kPi / 2}) {
    const Matrix3d rotation = RotationFromEulerXyz({0.7, b, 0.4});
    EXPECT_LT((RotationFromEulerXyz(EulerXyzFromRotation(rotation)) - rotation).norm(), 1e-6);
  }
}

TEST(RotationsTest, NearestRotationRecoversAndNeverReflects) {
  Random random(5);
  for (int i = 0; i < 50; ++i) {
    const Matrix3d rotation =
        QuaternionFromExponentialMap(RandomVector(random, 2)).toRotationMatrix();
    Matrix3d noisy = 3 * rotation;
    for (double& entry : noisy.reshaped()) entry += 1e-3 * random.Normal();
    EXPECT_LT((NearestRotation(noisy) - rotation).norm(), 5e-3);
    EXPECT_NEAR(NearestRotation(-rotation).determinant(), 1, 1e-12);
  }
}

}  // namespace
}  // namespace pleat
