#include "pleat/character/train_with_rig.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "absl/strings/str_cat.h"
#include "support/skinned_figure.h"
#include "support/smooth_poses.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

// A chain of joints with names of its own along a figure that moves: nothing human about it.
struct OwnRig {
  SkinnedFigure figure = MakeSkinnedFigure({.num_rings = 4, .num_sides = 4});
  MeshSequence clip = MakeSkinnedSequence(figure, MakeSmoothPoses(figure.rig.skeleton, 24, 7),
                                          MakeWaveDetails(figure, 24));
  UserRig rig{Renamed(figure.rig.skeleton), figure.rig.weights, 0, {}};

  static Skeleton Renamed(const Skeleton& skeleton) {
    std::vector<Joint> joints = skeleton.joints();
    for (size_t j = 0; j < joints.size(); ++j) joints[j].name = absl::StrCat("bone.", j);
    return *Skeleton::Create(std::move(joints));
  }
};

TrainOptions QuickOptions() {
  TrainOptions options;
  options.learner = LearnerChoice::kGp;
  return options;
}

TEST(TrainWithRig, KeepsNamesHierarchyAndLearns) {
  const OwnRig own;
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto model,
                             TrainCharacterWithRig({own.clip}, own.rig, QuickOptions()));
  ASSERT_EQ(model->skeleton().num_joints(), own.rig.skeleton.num_joints());
  for (int j = 0; j < model->skeleton().num_joints(); ++j) {
    EXPECT_EQ(model->skeleton().joint(j).name, own.rig.skeleton.joint(j).name);
    EXPECT_EQ(model->skeleton().parent(j), own.rig.skeleton.parent(j));
  }
  EXPECT_LT(model->record().reconstruction.mean_percent, model->record().fit.mean_percent);
}

TEST(TrainWithRig, ALockedRigKeepsItsJoints) {
  OwnRig own;
  for (int j = 0; j < own.rig.skeleton.num_joints(); ++j) own.rig.locked_joints.push_back(j);
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto locked,
                             TrainCharacterWithRig({own.clip}, own.rig, QuickOptions()));
  EXPECT_EQ(locked->skeleton().RestPositions(), own.rig.skeleton.RestPositions());
  TrainOptions as_it_is = QuickOptions();
  as_it_is.refine = RigRefinement::kNone;
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto kept, TrainCharacterWithRig({own.clip}, own.rig, as_it_is));
  EXPECT_EQ(kept->rig().weights.ToDense(), own.rig.weights->ToDense());
  EXPECT_EQ(kept->skeleton().RestPositions(), own.rig.skeleton.RestPositions());
}

TEST(TrainWithRig, ALockedJointStaysWhileOthersAreRefined) {
  OwnRig own;
  Eigen::Matrix3Xd joints = own.rig.skeleton.RestPositions();
  joints.row(0).array() += .01;  // so that refinement has something to move
  own.rig.skeleton = own.rig.skeleton.WithRestPositions(joints);
  own.rig.locked_joints = {5, 16};
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto model,
                             TrainCharacterWithRig({own.clip}, own.rig, QuickOptions()));
  for (int j = 0; j < model->skeleton().num_joints(); ++j) {
    if (own.rig.skeleton.children(j).empty()) continue;
    const bool stays = model->skeleton().rest_position(j) == own.rig.skeleton.rest_position(j);
    EXPECT_EQ(stays, j == 5 || j == 16) << j;
  }
}

// A rope of 256 joints, the most that a rig may have.
TEST(TrainWithRig, TakesTheMostJointsThereMayBe) {
  std::vector<Joint> joints;
  std::vector<std::vector<JointInfluence>> influences;
  std::vector<int32_t> corners;
  Eigen::Matrix3Xd rest(3, 3 * kMaxUserJoints);
  for (int j = 0; j < kMaxUserJoints; ++j) {
    joints.push_back({absl::StrCat("link ", j), j - 1, {0, .01 * j, 0}});
    for (int s = 0; s < 3; ++s) {
      const int v = 3 * j + s, next = 3 * j + (s + 1) % 3;
      rest.col(v) << .02 * std::cos(2.1 * s), .01 * j - .005, .02 * std::sin(2.1 * s);
      influences.push_back({{std::max(0, j - 1), 1}});
      if (j + 1 < kMaxUserJoints) {
        corners.insert(corners.end(), {v, next, next + 3, v, next + 3, v + 3});
      }
    }
  }
  const Skeleton skeleton = *Skeleton::Create(std::move(joints));
  PLEAT_ASSERT_OK_AND_ASSIGN(const UserRig rig, RigFromJointWeights(skeleton, influences, rest));
  ASSERT_EQ(rig.skeleton.num_joints(), kMaxUserJoints);
  SkinnedFigure figure;
  figure.topology = *Topology::Create(static_cast<int>(rest.cols()), corners,
                                      std::vector<int32_t>(corners.size() / 3, 3));
  figure.rig = {rig.skeleton, *rig.weights, rest};
  const MeshSequence clip = MakeSkinnedSequence(figure, MakeSmoothPoses(rig.skeleton, 4, 3, .05));
  TrainOptions options = QuickOptions();
  options.refine = RigRefinement::kNone;
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto model, TrainCharacterWithRig({clip}, rig, options));
  EXPECT_EQ(model->skeleton().num_joints(), kMaxUserJoints);
  EXPECT_EQ(model->skeleton().joint(255).name, "link 255");
  EXPECT_LT(model->record().fit.mean_percent, .5);
}

TEST(TrainWithRig, ComputesMissingWeights) {
  OwnRig own;
  own.rig.weights.reset();
  TrainOptions options = QuickOptions();
  options.refine = RigRefinement::kNone;
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto model, TrainCharacterWithRig({own.clip}, own.rig, options));
  EXPECT_EQ(model->rig().weights.num_vertices(), own.clip.num_vertices());
}

TEST(TrainWithRig, RefusesWhatDoesNotFit) {
  const OwnRig own;
  UserRig wrong = own.rig;
  wrong.rest_frame = 24;
  EXPECT_THAT(TrainCharacterWithRig({own.clip}, wrong, QuickOptions()),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("rest_frame 24")));
  wrong = own.rig;
  wrong.weights = *SkinWeights::FromDense(Eigen::MatrixXd::Ones(3, 18));
  EXPECT_THAT(TrainCharacterWithRig({own.clip}, wrong, QuickOptions()),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("3 vertices")));
}

}  // namespace
}  // namespace pleat
