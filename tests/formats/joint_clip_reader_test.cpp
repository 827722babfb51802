#include "pleat/formats/joint_clip_reader.h"

#include <gmock/gmock.h>

#include "formats/figure_character.h"
#include "pleat/base/file.h"
#include "pleat/formats/bvh.h"
#include "pleat/formats/character_file.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using testing::HasSubstr;

TEST(JointClipReaderTest, BvhAndGlbHaveTheSameJoints) {
  const TemporaryFolder folder;
  const CharacterFile character = FigureCharacter(4);
  const JointClip clip = ClipFromPoses(character.rig.skeleton, character.track);
  ASSERT_THAT(WriteBvh(folder.File("a.bvh"), clip), IsOk());
  ASSERT_THAT(WriteCharacterGlb(folder.File("a.glb"), character), IsOk());
  PLEAT_ASSERT_OK_AND_ASSIGN(const JointClipFile bvh, ReadJointClip(folder.File("a.bvh")));
  PLEAT_ASSERT_OK_AND_ASSIGN(const JointClipFile glb, ReadJointClip(folder.File("a.glb")));
  for (const ClipJoint& joint : clip.joints) {
    EXPECT_GE(bvh.clip.FindJoint(joint.name), 0) << joint.name;
    EXPECT_GE(glb.clip.FindJoint(joint.name), 0) << joint.name;
  }
  EXPECT_EQ(bvh.clip.num_frames(), 4u);
  EXPECT_EQ(glb.clip.num_frames(), 4u);
}

TEST(JointClipReaderTest, OtherFilesAreRefusedByName) {
  const TemporaryFolder folder;
  ASSERT_THAT(WriteFile(folder.File("a.json"), "{\"schema\": \"pleat.motion/1\"}"), IsOk());
  EXPECT_THAT(ReadJointClip(folder.File("a.json")),
              HasStatus(kInvalid, testing::AllOf(HasSubstr("a.json"), HasSubstr(".bvh, .glb"))));
  ASSERT_THAT(WriteFile(folder.File("a.bvh"), "nothing"), IsOk());
  EXPECT_THAT(ReadJointClip(folder.File("a.bvh")), HasStatus(kInvalid, HasSubstr("a.bvh: line 1")));
  EXPECT_THAT(ReadJointClip(folder.File("b.bvh")),
              HasStatus(absl::StatusCode::kNotFound, HasSubstr("b.bvh")));
}

}  // namespace
}  // namespace pleat
