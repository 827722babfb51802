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
  UserRig rig{Renamed(figure.rig.skeleton), figure.rig.weights, 0, false};

  static Skeleton Renamed(const Skeleton& skeleton) {
    std::vector<Joint> joints = skeleton.joints();
    for (size_t j = 0; j < joints.size(); ++j) joints[j].name = absl::StrCat("bone.", j);
    return *Skeleton::Create(std::move(joints));
  }
};

TrainOptions QuickOptions() {
  TrainOptions options;
  options.learner = "gp";
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
  own.rig.is_locked = true;
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto locked,
                             TrainCharacterWithRig({own.clip}, own.rig, QuickOptions()));
  EXPECT_EQ(locked->skeleton().RestPositions(), own.rig.skeleton.RestPositions());
  TrainOptions as_it_is = QuickOptions();
  as_it_is.refine = "none";
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto kept, TrainCharacterWithRig({own.clip}, own.rig, as_it_is));
  EXPECT_EQ(kept->rig().weights.ToDense(), own.rig.weights->ToDense());
  EXPECT_EQ(kept->skeleton().RestPositions(), own.rig.skeleton.RestPositions());
}

TEST(TrainWithRig, ComputesMissingWeights) {
  OwnRig own;
  own.rig.weights.reset();
  TrainOptions options = QuickOptions();
  options.refine = "none";
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
