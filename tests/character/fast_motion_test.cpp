// Fits of motion that is too fast to be followed from frame to frame: left must stay left.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "pleat/base/random.h"
#include "pleat/fitting/pose_fit.h"
#include "pleat/skeleton/human_template.h"
#include "support/status_matchers.h"
#include "trained_performer.h"

namespace pleat {
namespace {

// Every 7th frame of a dance, each thrown somewhere else: turned about the vertical by any angle,
// tilted, and moved by meters.
MeshSequence ThrownAbout(const MeshSequence& sequence, const PoseTrack& truth,
                         std::vector<Eigen::Matrix3Xd>* joints, const Skeleton& skeleton) {
  Random random(21);
  std::vector<Eigen::Matrix3Xf> frames;
  for (int t = 0; t < sequence.num_frames(); t += 7) {
    const Eigen::Matrix3d turn =
        (Eigen::AngleAxisd(random.Uniform(-1, 1) * std::numbers::pi, Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(0.4 * random.Normal(), Eigen::Vector3d::UnitX()))
            .toRotationMatrix();
    const Eigen::Vector3d shift(random.Normal(), random.Normal(), random.Normal());
    BoneTransforms transforms;
    ComputeBoneTransforms(skeleton, truth.pose(t), {}, &transforms);
    joints->push_back((turn * transforms.joint_positions).colwise() + shift);
    frames.push_back(((turn * sequence.FrameAsDouble(t)).colwise() + shift).cast<float>());
  }
  return MeshSequence::Create(sequence.topology(), std::move(frames)).value();
}

TEST(FastMotionTest, LeftAndRightAreNeverSwapped) {
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const Performer performer,
      GeneratePerformer({.seed = 3, .num_frames = 140, .num_vertices = 900}));
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto model,
                             TrainCharacter({performer.sequence}, FastTrainOptions()));
  std::vector<Eigen::Matrix3Xd> truth;
  const MeshSequence thrown =
      ThrownAbout(performer.sequence, performer.truth.track, &truth, performer.truth.rig.skeleton);
  PLEAT_ASSERT_OK_AND_ASSIGN(const PoseTrack track, FitPoses(thrown, model->rig(), {}, nullptr));
  for (int t = 0; t < thrown.num_frames(); ++t) {
    BoneTransforms transforms;
    ComputeBoneTransforms(model->skeleton(), track.pose(t), {}, &transforms);
    const Eigen::Matrix3Xd& found = transforms.joint_positions;
    for (const auto& [left, right] :
         {std::pair(kLeftLowerLeg, kRightLowerLeg), std::pair(kLeftFoot, kRightFoot),
          std::pair(kLeftLowerArm, kRightLowerArm), std::pair(kLeftHand, kRightHand)}) {
      const double kept = (found.col(left) - truth[t].col(left)).norm() +
                          (found.col(right) - truth[t].col(right)).norm();
      const double swapped = (found.col(left) - truth[t].col(right)).norm() +
                             (found.col(right) - truth[t].col(left)).norm();
      EXPECT_LT(kept, 0.5 * swapped) << "frame " << t << ", joint " << left;
    }
    // Bones keep their lengths: the skeleton only turns.
    for (int j = 1; j < kNumHumanJoints; ++j) {
      const int parent = model->skeleton().parent(j);
      const double rest =
          (model->skeleton().rest_position(j) - model->skeleton().rest_position(parent)).norm();
      EXPECT_NEAR((found.col(j) - found.col(parent)).norm(), rest, 1e-9);
    }
  }
}

}  // namespace
}  // namespace pleat
