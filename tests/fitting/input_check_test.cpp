#include "input_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/skinned_figure.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class InputCheckTest : public testing::Test {
 protected:
  const SkinnedFigure figure_ = MakeSkinnedFigure();
  const PoseTrack track_ = MakeSmoothPoses(figure_.rig.skeleton, 3, 21);
  const MeshSequence sequence_ = MakeSkinnedSequence(figure_, track_);
};

// The weights and the rest mesh of a rig may come from different files.
TEST_F(InputCheckTest, NamesTheCountsOfARigOfAnotherMesh) {
  EXPECT_THAT(CheckRigOfSequence("a step", sequence_, figure_.rig), IsOk());
  const Rig other = MakeSkinnedFigure({.num_rings = 4}).rig;
  Rig mixed = figure_.rig;
  mixed.rest_positions = other.rest_positions;
  EXPECT_THAT(CheckRigOfSequence("a step", sequence_, mixed),
              HasStatus(absl::StatusCode::kInvalidArgument,
                        AllOf(HasSubstr("a step: "), HasSubstr("612 skinned and 408 rest"))));
  mixed = figure_.rig;
  mixed.weights = other.weights;
  EXPECT_THAT(CheckRigOfSequence("a step", sequence_, mixed),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("408 skinned and 612 rest")));
}

TEST_F(InputCheckTest, RefusesPosesOfOtherFramesOrAnotherSkeleton) {
  const auto check = [&](PoseTrack::Parts parts) {
    return CheckTrackOfSequence("a step", sequence_, figure_.rig,
                                PoseTrack::FromValid(std::move(parts)));
  };
  EXPECT_THAT(check(track_.parts()), IsOk());
  PoseTrack::Parts parts = track_.parts();
  parts.poses.pop_back();
  EXPECT_THAT(check(parts), HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("2 frames")));
  parts = track_.parts();
  for (Pose& pose : parts.poses) pose.rotations.pop_back();
  EXPECT_THAT(check(parts), HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("joints")));
}

}  // namespace
}  // namespace pleat
