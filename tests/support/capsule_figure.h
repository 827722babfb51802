// A clothed-looking human of capsules with known joints.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "pleat/skeleton/human_template.h"
#include "support/triangle_shapes.h"

namespace pleat {

struct CapsuleFigure {
  TriangleMesh mesh;
  Eigen::Matrix3Xd joints;  // 3 x 18, template order, meters
};

struct CapsuleFigureOptions {
  double height_m = 1.7;
  double yaw_degrees = 0;         // 0 faces +z
  double arm_angle_degrees = 50;  // of the arms below the horizon
  double elbow_degrees = 0;       // bend of the elbows, forwards
  double arm_length = 1;          // share of a whole arm
  bool skirt = false;             // a closed bell from the hips to above the knees
  double leg_length = 1;          // share of a whole leg; what is above it comes down
  double girth = 1;               // of the trunk
  double cell_m = 0.02;
};

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
  return joints;
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
  add(joints.col(kHead), joints.col(kHead) + Eigen::Vector3d(0, .005, .01), .06, .065);
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
    add(joints.col(hand), tip, .022, .022);
  }
  if (options.skirt) add({0, .5, 0}, {0, .40, 0}, .095, .13);
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
  return {MakeCapsuleBody(CapsuleFigureParts(options), options.cell_m),
          options.height_m * (turn * CapsuleFigureJoints(options))};
}

}  // namespace pleat
