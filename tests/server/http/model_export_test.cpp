#include "model_export.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <utility>

#include "formats/model_builder.h"
#include "support/status_matchers.h"
#include "support/test_meshes.h"

namespace pleat {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::StartsWith;

Motion RestMotion(const CharacterModel& model, int num_frames) {
  PoseTrack::Parts parts;
  parts.fps = 25;
  parts.poses.assign(static_cast<size_t>(num_frames), Pose::Rest(model.skeleton()));
  Motion motion;
  motion.track = PoseTrack::Create(std::move(parts)).value();
  return motion;
}

TEST(ModelExportTest, EveryNameThatIsOfferedIsWritten) {
  const auto model = SmallModelBuilder(Learner::kGp).Build();
  const MeshSequence tube = MakeSwayingTube(3);
  for (const std::string& name : ExportFormats()) {
    const EncodeFrames encode = FindFramesFormat(name);
    const absl::StatusOr<std::string> bytes =
        encode != nullptr ? encode(tube) : EncodeCharacterAs(name, model, RestMotion(*model, 3));
    ASSERT_THAT(bytes, IsOk()) << name;
    EXPECT_GT(bytes->size(), 100u) << name;
  }
  EXPECT_THAT(EncodeCharacterAs("exe", model, RestMotion(*model, 3)),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("character.glb")));
}

TEST(ModelExportTest, ACharacterHasItsFoldsAsMorphTargets) {
  const auto model = SmallModelBuilder(Learner::kGp).Build();
  const std::string glb = EncodeCharacterAs("character.glb", model, RestMotion(*model, 3)).value();
  EXPECT_THAT(glb, StartsWith("glTF"));
  EXPECT_THAT(glb, HasSubstr("\"targets\""));
  EXPECT_THAT(glb, HasSubstr("\"skins\""));
}

TEST(ModelExportTest, WhatAFileCannotHoldIsSaid) {
  const auto model = SmallModelBuilder(Learner::kGp).Build();
  Motion motion = RestMotion(*model, 2);
  motion.detail_strengths = {1, 0, 1};
  EXPECT_THAT(EncodeCharacterAs("character.glb", model, motion),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("strengths")));
  EXPECT_THAT(EncodeCharacterAs("character.usda", model, motion), IsOk());
  motion = RestMotion(*model, 2);
  motion.bone_scales = {1, 2, 1};
  EXPECT_THAT(EncodeCharacterAs("character.usda", model, motion),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("bone_scales")));
}

}  // namespace
}  // namespace pleat
