// A limb of two bones that reaches a point (docs/method/motion.md#feet).
#pragma once

#include <Eigen/Core>

namespace pleat {

struct TwoBoneLimb {
  Eigen::Vector3d begin, middle, end;  // meters: hip, knee, ankle
  // Unit axis about which the limb bends further, by the right hand: for a straight limb, whose
  // joints do not show it.
  Eigen::Vector3d hinge;
};

// How the two bones turn in the world, from the left.
struct TwoBoneTurns {
  Eigen::Matrix3d upper, lower;
  bool reached = true;  // false: the limb is stretched, or folded, towards the point
};

// Turns the limb so that it ends in `goal`, as far as its lengths allow. The limb keeps the plane
// in which it bends: it bends or stretches about its hinge first and then turns to the goal the
// shortest way.
TwoBoneTurns SolveTwoBone(const TwoBoneLimb& limb, const Eigen::Vector3d& goal);

}  // namespace pleat
