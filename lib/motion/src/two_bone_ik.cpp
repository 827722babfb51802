#include "pleat/motion/two_bone_ik.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "rest_alignment.h"

namespace pleat {
namespace {

// A limb that bends by less than this (sine) has no plane of its own.
constexpr double kMinBendSine = .02;
// Of its whole length. A limb never becomes quite straight: its plane would be lost.
constexpr double kMaxStretch = .9995;

}  // namespace

TwoBoneTurns SolveTwoBone(const TwoBoneLimb& limb, const Eigen::Vector3d& goal) {
  const Eigen::Vector3d upper = limb.middle - limb.begin, lower = limb.end - limb.middle;
  const double a = upper.norm(), b = lower.norm();
  const double wanted = (goal - limb.begin).norm();
  const double shortest = std::abs(a - b) + 1e-3 * (a + b);
  const double distance = std::clamp(wanted, shortest, std::max(shortest, kMaxStretch * (a + b)));
  TwoBoneTurns turns{Eigen::Matrix3d::Identity(), Eigen::Matrix3d::Identity(),
                     std::abs(distance - wanted) <= 1e-9 * (a + b)};
  if (!(a > 0) || !(b > 0)) return turns;
  Eigen::Vector3d axis = upper.cross(lower);
  const double bend_sine = axis.norm() / (a * b);
  axis = bend_sine > kMinBendSine ? axis.normalized() : limb.hinge;
  if (axis.dot(limb.hinge) < 0) axis = -axis;  // bent backwards: it bends the right way from here
  const double has = std::atan2(axis.dot(upper.cross(lower)), upper.dot(lower));
  const double cosine = (distance * distance - a * a - b * b) / (2 * a * b);
  const double needs = std::acos(std::clamp(cosine, -1., 1.));
  const Eigen::Matrix3d bend = Eigen::AngleAxisd(needs - has, axis).toRotationMatrix();
  const Eigen::Matrix3d aim = ShortestTurn(upper + bend * lower, goal - limb.begin);
  turns.upper = aim;
  turns.lower = aim * bend;
  return turns;
}

}  // namespace pleat
