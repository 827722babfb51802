#include "pleat/character/joint_confidence.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "pleat/character/pose_evaluator.h"
#include "support/fake_training.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

// A model whose training rows are exactly the poses of a motion at rest from frame to frame.
class JointConfidenceTest : public ::testing::Test {
 protected:
  Pose PoseAt(double chest, double head) const {
    Pose pose = Pose::Rest(model_->skeleton());
    pose.rotations[1] = Eigen::AngleAxisd(chest, Eigen::Vector3d::UnitX());
    pose.rotations[2] = Eigen::AngleAxisd(head, Eigen::Vector3d::UnitZ());
    return pose;
  }
  std::vector<double> At(const Pose& pose) const {
    std::vector<double> confidence;
    EXPECT_TRUE(JointConfidence(*model_, {&pose}, &confidence).ok());
    return confidence;
  }

  const std::shared_ptr<const CharacterModel> model_ =
      MakeFakeModel(MakeSwayingTube(2), {.history = 1});
  // The rows of the fake model, whose features are exponential maps without scaling.
  const GpRegressionParameters rows_ = model_->detail_model().stages().front().parameters();
};

TEST_F(JointConfidenceTest, ItIsTheKernelOfTheNearestRowInEachJointAlone) {
  const Pose pose = PoseAt(.4, -.7);
  const std::vector<double> confidence = At(pose);
  ASSERT_EQ(confidence.size(), 3u);
  EXPECT_EQ(confidence[0], 1);
  const double g = std::exp(rows_.kernel.inverse_width);
  const Eigen::Vector3d chest(.4, 0, 0), head(0, 0, -.7);
  double nearest_chest = 1e9, nearest_head = 1e9;
  for (Eigen::Index i = 0; i < rows_.inputs.rows(); ++i) {
    const Eigen::VectorXd row = rows_.inputs.row(i).transpose();
    nearest_chest = std::min(nearest_chest, (row.head(3) - chest).squaredNorm());
    nearest_head = std::min(nearest_head, (row.segment(3, 3) - head).squaredNorm());
  }
  EXPECT_NEAR(confidence[1], std::exp(-g / 2 * nearest_chest), 1e-12);
  EXPECT_NEAR(confidence[2], std::exp(-g / 2 * nearest_head), 1e-12);
}

TEST_F(JointConfidenceTest, AJointOfATrainingRowHasConfidenceOneWhateverTheOthersDo) {
  Pose pose = PoseAt(0, 2.5);
  const Eigen::Vector3d seen = rows_.inputs.row(1).head(3).transpose();
  pose.rotations[1] = Eigen::AngleAxisd(seen.norm(), seen.normalized());
  const std::vector<double> confidence = At(pose);
  EXPECT_NEAR(confidence[1], 1, 1e-9);
  EXPECT_LT(confidence[2], .9);
}

TEST_F(JointConfidenceTest, NeitherPlaceNorFacingMatters) {
  Pose pose = PoseAt(.2, .3);
  const std::vector<double> before = At(pose);
  pose.root_position += Eigen::Vector3d(5, 0, -3);
  pose.rotations[0] = Eigen::AngleAxisd(2, Eigen::Vector3d::UnitY());
  EXPECT_EQ(At(pose), before);
}

TEST_F(JointConfidenceTest, PosesThatDoNotFitAreRefused) {
  std::vector<double> confidence;
  EXPECT_THAT(JointConfidence(*model_, {}, &confidence),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("at least one pose")));
  Pose pose = PoseAt(0, 0);
  pose.rotations.pop_back();
  EXPECT_THAT(JointConfidence(*model_, {&pose}, &confidence),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("2")));
}

}  // namespace
}  // namespace pleat
