// The 18-joint human template of the paper (docs/method/rig.md#the-template).
#pragma once

#include <array>

#include "pleat/skeleton/skeleton.h"

namespace pleat {

inline constexpr int kNumHumanJoints = 18;

// Joint indices of the template; names are those of the Unity / VRM humanoid.
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

// Rest positions in fractions of body height: +x to the character's left, facing +z, floor y = 0.
const Skeleton& HumanTemplate();

// Left/right counterpart of every joint; a joint of the middle is its own.
const std::array<int, kNumHumanJoints>& HumanMirror();

}  // namespace pleat
