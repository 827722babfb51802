// A clothed-looking human of capsules with known joints.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <vector>

#include "pleat/skeleton/human_template.h"
#include "support/triangle_shapes.h"

namespace pleat {

struct CapsuleFigure {
  TriangleMesh mesh;
  Eigen::Matrix3Xd joints;  // 3 x 18, template order, meters
};

// Where the arms are. All but the first say where elbows and hands are.
enum class ArmPose {
  kStraight,   // arm_angle_degrees and elbow_degrees say it
  kCrossed,    // forearms over each other before the chest, each hand at the other elbow
  kFolded,     // forearms before the belly, the hands on each other
  kPraying,    // hands against each other before the chest, elbows out
  kOnHips,     // elbows out
  kBehindBack  // hands on each other behind the hips
};

struct CapsuleFigureOptions {
  double height_m = 1.7;
  double yaw_degrees = 0;         // 0 faces +z
  double arm_angle_degrees = 50;  // of the arms below the horizon
  double elbow_degrees = 0;       // bend of the elbows, forwards
  double arm_length = 1;          // share of a whole arm
  bool skirt = false;             // a closed bell from the hips to above the knees
  ArmPose arms = ArmPose::kStraight;
  double robe_hem = 0;          // radius of a robe at the floor, share of the height; 0 = none
  bool robe_is_hollow = false;  // a bell of cloth with the legs inside of it, open below
  double sleeve = 0;      // radius of the sleeves at the wrists, share of the height; 0 = none
  double leg_length = 1;  // share of a whole leg; what is above it comes down
  double girth = 1;       // of the trunk
  double head = 1;        // size of the head: cartoons have large ones
  bool fingers = false;   // five thin ones, spread
  double cell_m = 0.02;
};

// Places elbow and hand of the left arm; those of the right one mirror them.
inline void PoseLeftArm(ArmPose pose, double arm_length, Eigen::Matrix3Xd* joints) {
  Eigen::Vector3d upper = Eigen::Vector3d::Zero(), fore = upper;  // directions
  switch (pose) {
    case ArmPose::kStraight:
      return;
    case ArmPose::kCrossed:
      upper << .15, -.96, .26;
      fore << -.85, .2, .5;
      break;
    case ArmPose::kFolded:
      upper << .2, -.97, .1;
      fore << -.76, -.1, .64;
      break;
    case ArmPose::kPraying:
      upper << .3, -.85, .43;
      fore << -.8, .35, .5;
      break;
    case ArmPose::kOnHips:
      upper << .75, -.65, -.1;
      fore << -.62, -.76, .2;
      break;
    case ArmPose::kBehindBack:
      upper << .2, -.95, -.25;
      fore << -.75, -.45, -.5;
      break;
  }
  joints->col(kLeftLowerArm) = joints->col(kLeftUpperArm) + .165 * arm_length * upper.normalized();
  joints->col(kLeftHand) = joints->col(kLeftLowerArm) + .16 * arm_length * fore.normalized();
}

// Joints of the figure that faces +z, in fractions of its height; proportions differ from the
// template's on purpose.
inline Eigen::Matrix3Xd CapsuleFigureJoints(const CapsuleFigureOptions& options) {
  const double angle = options.arm_angle_degrees * EIGEN_PI / 180;
  const Eigen::Vector3d along_arm(std::cos(angle), -std::sin(angle), 0.12);
  const double bend = options.elbow_degrees * EIGEN_PI / 180;
  const Eigen::Vector3d along_forearm =
      std::cos(bend) * along_arm + std::sin(bend) * Eigen::Vector3d::UnitZ();
  Eigen::Matrix3Xd joints(3, kNumHumanJoints);
  joints.col(kHips) << 0, .525, 0;
  joints.col(kSpine) << 0, .64, .005;
  joints.col(kChest) << 0, .79, -.01;
  joints.col(kHead) << 0, .93, .005;
  joints.col(kLeftUpperLeg) << .055, .51, 0;
  joints.col(kLeftLowerLeg) << .066, .28, -.005;
  joints.col(kLeftFoot) << .075, .04, -.02;
  joints.col(kLeftToes) << .085, .025, .075;
  joints.col(kLeftUpperArm) << .11, .79, -.01;
  joints.col(kLeftLowerArm) = joints.col(kLeftUpperArm) + .165 * options.arm_length * along_arm;
  joints.col(kLeftHand) = joints.col(kLeftLowerArm) + .16 * options.arm_length * along_forearm;
  PoseLeftArm(options.arms, options.arm_length, &joints);
  // The feet keep their size.
  const double lowered = (1 - options.leg_length) * (.51 - .04);
  for (int j = 0; j < kNumHumanJoints; ++j) {
    if (j == kLeftFoot || j == kLeftToes || HumanMirror()[j] < j) continue;
    joints(1, j) -= j == kLeftLowerLeg ? .5 * lowered : lowered;
  }
  for (int j = 0; j < kNumHumanJoints; ++j) {
    const int left = HumanMirror()[j];
    if (left < j) joints.col(j) = Eigen::Vector3d(-1, 1, 1).cwiseProduct(joints.col(left));
  }
  if (options.arms == ArmPose::kCrossed) {  // the left forearm lies on the right one
    joints.col(kLeftLowerArm) += Eigen::Vector3d(0, .01, .02);
    joints.col(kLeftHand) += Eigen::Vector3d(0, .02, .03);
  }
  return joints;
}

// Adds the capsules of a robe from the waist to the floor by add(start, end, radius, radius). The
// round end of a solid one lies below the floor, where the body is cut off.
template <typename Add>
void AddRobe(const CapsuleFigureOptions& options, const Add& add) {
  if (!(options.robe_hem > 0)) return;
  const double waist = options.girth * .085;
  if (!options.robe_is_hollow) {
    add({0, .6, 0}, {0, 0, 0}, waist, options.robe_hem);
    return;
  }
  constexpr int kNumFolds = 24;
  constexpr double kCloth = .016;
  for (int k = 0; k < kNumFolds; ++k) {
    const double angle = 2 * EIGEN_PI * k / kNumFolds;
    const Eigen::Vector3d out(std::cos(angle), 0, std::sin(angle));
    add((waist - kCloth) * out + Eigen::Vector3d(0, .6, 0),
        (options.robe_hem - kCloth) * out + Eigen::Vector3d(0, kCloth, 0), kCloth, kCloth);
  }
}

// Adds a palm with five spread fingers by add(start, end, radius, radius).
template <typename Add>
void AddFingers(const Eigen::Vector3d& elbow, const Eigen::Vector3d& hand, const Add& add) {
  const Eigen::Vector3d along = (hand - elbow).normalized();
  const Eigen::Vector3d across = along.cross(Eigen::Vector3d::UnitY()).normalized();
  const Eigen::Vector3d knuckles = hand + .045 * along;
  add(hand, knuckles, .02, .018);
  for (int k = -2; k <= 2; ++k) {
    const double angle = 22 * k * EIGEN_PI / 180;
    const Eigen::Vector3d direction = std::cos(angle) * along + std::sin(angle) * across;
    add(knuckles + .006 * k * across, knuckles + .006 * k * across + .05 * direction, .007, .006);
  }
}

// The parts of the figure, which overlap where it bends.
inline std::vector<Capsule> CapsuleFigureParts(const CapsuleFigureOptions& options = {}) {
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(options.yaw_degrees * EIGEN_PI / 180, Eigen::Vector3d::UnitY())
          .toRotationMatrix();
  const double height = options.height_m, girth = options.girth;
  const Eigen::Matrix3Xd joints = CapsuleFigureJoints(options);
  std::vector<Capsule> capsules;
  const auto add = [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b, double ra, double rb) {
    capsules.push_back({height * a, height * b, height * ra, height * rb});
  };
  add(joints.col(kHips), joints.col(kSpine), girth * .085, girth * .08);
  add(joints.col(kSpine), joints.col(kChest), girth * .08, .085);
  add(joints.col(kChest), joints.col(kHead), .035, .035);
  // The bottom of the head stays where it is.
  const Eigen::Vector3d head = joints.col(kHead) + Eigen::Vector3d(0, .06 * (options.head - 1), 0);
  add(head, head + Eigen::Vector3d(0, .005, .01), options.head * .06, options.head * .065);
  for (const auto& [hip, knee, ankle, toes, shoulder, elbow, hand] :
       {std::array{kLeftUpperLeg, kLeftLowerLeg, kLeftFoot, kLeftToes, kLeftUpperArm, kLeftLowerArm,
                   kLeftHand},
        std::array{kRightUpperLeg, kRightLowerLeg, kRightFoot, kRightToes, kRightUpperArm,
                   kRightLowerArm, kRightHand}}) {
    add(joints.col(hip), joints.col(knee), .055, .036);
    add(joints.col(knee), joints.col(ankle), .034, .027);
    add(joints.col(ankle) - Eigen::Vector3d(0, .015, .01), joints.col(toes), .025, .022);
    add(joints.col(kChest), joints.col(shoulder), .05, .04);
    add(joints.col(shoulder), joints.col(elbow), .036, .027);
    add(joints.col(elbow), joints.col(hand), .026, .022);
    const Eigen::Vector3d tip = joints.col(hand) + .25 * (joints.col(hand) - joints.col(elbow));
    if (options.fingers) {
      AddFingers(joints.col(elbow), joints.col(hand), add);
    } else {
      add(joints.col(hand), tip, .022, .022);
    }
    if (options.sleeve > 0) add(joints.col(elbow), joints.col(hand), .03, options.sleeve);
  }
  if (options.skirt) add({0, .5, 0}, {0, .40, 0}, .095, .13);
  AddRobe(options, add);
  for (Capsule& capsule : capsules) {
    capsule.start = turn * capsule.start;
    capsule.end = turn * capsule.end;
  }
  return capsules;
}

inline CapsuleFigure MakeCapsuleFigure(const CapsuleFigureOptions& options = {}) {
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(options.yaw_degrees * EIGEN_PI / 180, Eigen::Vector3d::UnitY())
          .toRotationMatrix();
  return {MakeCapsuleBody(CapsuleFigureParts(options), options.cell_m, 0),
          options.height_m * (turn * CapsuleFigureJoints(options))};
}

}  // namespace pleat
