// The 18-joint human template of the paper (docs/method/rig.md#the-template).
#pragma once

#include <array>

#include "pleat/skeleton/skeleton.h"

namespace pleat {

inline constexpr int kNumHumanJoints = 18;

// The joint indices of the template. The names are those of the Unity and VRM humanoid.
enum HumanJoint : int {
  kHips,
  kSpine,
  kChest,
  kHead,
  kLeftUpperLeg,
  kLeftLowerLeg,
  kLeftFoot,
  kLeftToes,
  kRightUpperLeg,
  kRightLowerLeg,
  kRightFoot,
  kRightToes,
  kLeftUpperArm,
  kLeftLowerArm,
  kLeftHand,
  kRightUpperArm,
  kRightLowerArm,
  kRightHand,
};

// Returns the template. Rest positions are fractions of the body height: the character faces +z,
// its left side is at +x, and the floor is y = 0.
const Skeleton& HumanTemplate();

// Returns the joint on the other side of the body for every joint. A joint in the middle is its own
// counterpart.
const std::array<int, kNumHumanJoints>& HumanMirror();

}  // namespace pleat
