#include "pleat/skeleton/pose.h"

#include <gtest/gtest.h>

#include "pleat/math/rotations.h"
#include "pleat/skeleton/human_template.h"
#include "support/smooth_poses.h"

namespace pleat {
namespace {

Eigen::Vector3d Map(const BoneTransforms& transforms, int b, const Eigen::Vector3d& rest) {
  return transforms.linear[b] * rest + transforms.translation[b];
}

TEST(PoseTest, RestPoseMovesNothing) {
  const Skeleton& skeleton = HumanTemplate();
  BoneTransforms transforms;
  ComputeBoneTransforms(skeleton, Pose::Rest(skeleton), {}, &transforms);
  EXPECT_LT((transforms.joint_positions - skeleton.RestPositions()).norm(), 1e-12);
  for (int b = 0; b < skeleton.num_joints(); ++b) {
    EXPECT_LT((Map(transforms, b, {0.3, -1, 2}) - Eigen::Vector3d(0.3, -1, 2)).norm(), 1e-12);
  }
}

TEST(PoseTest, ABoneTurnsAboutItsParentJoint) {
  // An elbow bent by 90 degrees about z takes the hand from +x to +y of the elbow.
  const Skeleton skeleton = *Skeleton::Create({{"root", -1, {0, 1, 0}},
                                               {"shoulder", 0, {1, 1, 0}},
                                               {"elbow", 1, {2, 1, 0}},
                                               {"hand", 2, {3, 1, 0}}});
  Pose pose = Pose::Rest(skeleton);
  pose.rotations[3] = QuaternionFromExponentialMap({0, 0, M_PI / 2});
  BoneTransforms transforms;
  ComputeBoneTransforms(skeleton, pose, {}, &transforms);
  EXPECT_LT((transforms.joint_positions.col(2) - Eigen::Vector3d(2, 1, 0)).norm(), 1e-12);
  EXPECT_LT((transforms.joint_positions.col(3) - Eigen::Vector3d(2, 2, 0)).norm(), 1e-12);
}

TEST(PoseTest, ChainsAreConnectedAndRigid) {
  const Skeleton& skeleton = HumanTemplate();
  const PoseTrack track = MakeSmoothPoses(skeleton, 10, 3, 1.0);
  BoneTransforms transforms;
  for (const Pose& pose : track.poses()) {
    ComputeBoneTransforms(skeleton, pose, {}, &transforms);
    EXPECT_LT((transforms.joint_positions.col(0) - pose.root_position).norm(), 1e-12);
    for (int b = 1; b < skeleton.num_joints(); ++b) {
      const int parent = skeleton.parent(b);
      // Both ends of the bone lie where the joints are.
      EXPECT_LT((Map(transforms, b, skeleton.rest_position(parent)) -
                 transforms.joint_positions.col(parent))
                    .norm(),
                1e-12);
      EXPECT_LT((Map(transforms, b, skeleton.rest_position(b)) - transforms.joint_positions.col(b))
                    .norm(),
                1e-12);
      EXPECT_LT((transforms.rotation[b] * transforms.rotation[b].transpose() -
                 Eigen::Matrix3d::Identity())
                    .norm(),
                1e-12);
    }
  }
}

TEST(PoseTest, BoneScalesLengthenBonesAlongTheirAxis) {
  const Skeleton& skeleton = HumanTemplate();
  const Pose pose = MakeSmoothPoses(skeleton, 5, 3).pose(4);
  std::vector<double> scales(skeleton.num_joints(), 1.0);
  scales[kLeftLowerLeg] = 1.5;
  BoneTransforms plain, scaled;
  ComputeBoneTransforms(skeleton, pose, {}, &plain);
  ComputeBoneTransforms(skeleton, pose, scales, &scaled);
  auto length = [&](const BoneTransforms& transforms, int b) {
    return (transforms.joint_positions.col(b) - transforms.joint_positions.col(skeleton.parent(b)))
        .norm();
  };
  for (int b = 1; b < skeleton.num_joints(); ++b) {
    EXPECT_NEAR(length(scaled, b), scales[b] * length(plain, b), 1e-12);
    EXPECT_EQ(scaled.rotation[b], plain.rotation[b]);
  }
  // Across its axis the scaled bone keeps its girth.
  const Eigen::Vector3d axis =
      skeleton.rest_position(kLeftLowerLeg) - skeleton.rest_position(kLeftUpperLeg);
  const Eigen::Vector3d across = axis.cross(Eigen::Vector3d(0, 0, 1)).normalized();
  EXPECT_NEAR((scaled.linear[kLeftLowerLeg] * across).norm(), 1, 1e-12);
}

}  // namespace
}  // namespace pleat
