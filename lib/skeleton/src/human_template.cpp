#include "pleat/skeleton/human_template.h"

#include <cassert>
#include <utility>

namespace pleat {

const Skeleton& HumanTemplate() {
  static const Skeleton skeleton = [] {
    std::vector<Joint> joints = {
        {"hips", -1, {0, .500, 0}},
        {"spine", kHips, {0, .612, .002}},
        {"chest", kSpine, {0, .785, -.020}},
        {"head", kChest, {0, .946, 0}},
        {"leftUpperLeg", kHips, {.050, .499, 0}},
        {"leftLowerLeg", kLeftUpperLeg, {.071, .282, -.030}},
        {"leftFoot", kLeftLowerLeg, {.098, .029, -.050}},
        {"leftToes", kLeftFoot, {.108, .021, .041}},
        {"rightUpperLeg", kHips, {-.050, .499, 0}},
        {"rightLowerLeg", kRightUpperLeg, {-.071, .282, -.030}},
        {"rightFoot", kRightLowerLeg, {-.098, .029, -.050}},
        {"rightToes", kRightFoot, {-.108, .021, .041}},
        {"leftUpperArm", kChest, {.099, .778, -.025}},
        {"leftLowerArm", kLeftUpperArm, {.197, .655, -.016}},
        {"leftHand", kLeftLowerArm, {.265, .531, .055}},
        {"rightUpperArm", kChest, {-.099, .778, -.025}},
        {"rightLowerArm", kRightUpperArm, {-.197, .655, -.016}},
        {"rightHand", kRightLowerArm, {-.265, .531, .055}},
    };
    absl::StatusOr<Skeleton> created = Skeleton::Create(std::move(joints));
    assert(created.ok());
    return *std::move(created);
  }();
  return skeleton;
}

const std::array<int, kNumHumanJoints>& HumanMirror() {
  static constexpr std::array<int, kNumHumanJoints> kMirror = {
      kHips,          kSpine,         kChest,        kHead,         kRightUpperLeg, kRightLowerLeg,
      kRightFoot,     kRightToes,     kLeftUpperLeg, kLeftLowerLeg, kLeftFoot,      kLeftToes,
      kRightUpperArm, kRightLowerArm, kRightHand,    kLeftUpperArm, kLeftLowerArm,  kLeftHand};
  return kMirror;
}

}  // namespace pleat
