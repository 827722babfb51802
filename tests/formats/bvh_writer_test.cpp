#include <gmock/gmock.h>

#include <numbers>

#include "clip_motion.h"
#include "formats/figure_character.h"
#include "pleat/formats/bvh.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(BvhWriterTest, WhatWasWrittenDrivesTheCharacterAsBefore) {
  const CharacterFile character = FigureCharacter(40);
  const std::string text = EncodeBvh(ClipFromPoses(character.rig.skeleton, character.track));
  PLEAT_ASSERT_OK_AND_ASSIGN(const BvhFile file, DecodeBvh(text));
  EXPECT_THAT(file.warnings, IsEmpty());
  PLEAT_ASSERT_OK_AND_ASSIGN(const Motion motion,
                             MotionFromClip(file.clip, character.rig.skeleton));
  // Seven digits of a degree and of a centimeter.
  EXPECT_LT(TrackDifference(motion.track, character.track), 5e-9);
  EXPECT_DOUBLE_EQ(motion.track.fps(), 30000. / 1001);
  EXPECT_THAT(motion.warnings, ElementsAre(HasSubstr("centimeters")));
}

TEST(BvhWriterTest, TheAnglesOfAllTurnsComeBack) {
  JointClip clip;
  clip.joints = {{.name = "a"}};
  for (int x = -180; x <= 180; x += 30) {
    for (int y = -180; y <= 180; y += 45) {
      for (int z = -180; z <= 180; z += 45) {
        const double radians = std::numbers::pi / 180;
        clip.rotations.push_back(Eigen::AngleAxisd(z * radians, Eigen::Vector3d::UnitZ()) *
                                 Eigen::AngleAxisd(x * radians, Eigen::Vector3d::UnitX()) *
                                 Eigen::AngleAxisd(y * radians, Eigen::Vector3d::UnitY()));
        clip.translations.emplace_back(0, 0, 0);
      }
    }
  }
  PLEAT_ASSERT_OK_AND_ASSIGN(const BvhFile file, DecodeBvh(EncodeBvh(clip)));
  ASSERT_EQ(file.clip.num_frames(), clip.num_frames());
  ASSERT_EQ(file.clip.num_joints(), 2u);  // with the end
  for (size_t t = 0; t < clip.num_frames(); ++t) {
    EXPECT_LT(file.clip.rotations[2 * t].angularDistance(clip.rotations[t]), 5e-8) << t;
  }
}

TEST(BvhWriterTest, ThePlainFormIsWhatOtherProgramsExpect) {
  JointClip clip;
  clip.fps = 25;
  clip.joints = {{.name = "hips", .offset = {0, 1, 0}}, {"knee {x}", 0, {0, -.5, 0}}};
  clip.rotations.assign(2, Eigen::Quaterniond::Identity());
  clip.rotations[1] = Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitX());
  clip.translations = {{0, 1.25, 0}, {0, -.5, 0}};
  EXPECT_EQ(EncodeBvh(clip), R"(HIERARCHY
ROOT hips
{
	OFFSET 0.0000000 0.0000000 0.0000000
	CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
	JOINT knee (x)
	{
		OFFSET 0.0000000 -50.0000000 0.0000000
		CHANNELS 3 Zrotation Xrotation Yrotation
		End Site
		{
			OFFSET 0.0000000 0.0000000 0.0000000
		}
	}
}
MOTION
Frames: 1
Frame Time: 0.0400000000
0.0000000 125.0000000 0.0000000 0.0000000 0.0000000 0.0000000 0.0000000 90.0000000 0.0000000
)");
}

}  // namespace
}  // namespace pleat
