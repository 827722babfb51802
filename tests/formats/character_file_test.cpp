#include "pleat/formats/character_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <utility>

#include "formats/model_builder.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

TEST(CharacterFileTest, AMotionWithoutFramesGivesTheRestPoseAtTheRateOfTheModel) {
  const auto model = SmallModelBuilder(Learner::kGp).Build();
  const CharacterFile file = MakeCharacterFile(*model, {}, kMaxInfluences).value();
  EXPECT_EQ(file.name, "small");
  EXPECT_EQ(file.track.num_frames(), 0);
  EXPECT_EQ(file.frame_rate, (FrameRate{25, 1}));
  EXPECT_EQ(file.rig.weights.vertex(0).weights[1], .25f);
}

TEST(CharacterFileTest, BonesAreCutAndTheRateIsThatOfTheMotion) {
  const auto model = SmallModelBuilder(Learner::kGp).Build();
  PoseTrack::Parts parts;
  parts.fps = 30000 / 1001.0;
  parts.poses = {Pose::Rest(model->skeleton())};
  Motion motion;
  motion.track = PoseTrack::Create(std::move(parts)).value();
  const CharacterFile file = MakeCharacterFile(*model, motion, 1).value();
  EXPECT_EQ(file.frame_rate, (FrameRate{30000, 1001}));
  EXPECT_EQ(file.rig.weights.vertex(0).weights[0], 1.f);
  EXPECT_EQ(file.track.num_frames(), 1);
}

TEST(CharacterFileTest, OtherProportionsAreRefused) {
  const auto model = SmallModelBuilder(Learner::kGp).Build();
  Motion motion;
  motion.bone_scales = {1, 1, 1};
  EXPECT_THAT(MakeCharacterFile(*model, motion, 4), IsOk());
  motion.bone_scales[2] = 1.5;
  EXPECT_THAT(MakeCharacterFile(*model, motion, 4),
              HasStatus(absl::StatusCode::kInvalidArgument, testing::HasSubstr("bone_scales")));
}

}  // namespace
}  // namespace pleat
