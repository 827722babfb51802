#include "glb_joints.h"

#include "clip_motion.h"
#include "formats/figure_character.h"
#include "formats/figure_glb.h"
#include "formats/gltf_evaluation.h"
#include "pleat/base/status.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// The JSON of a file may be edited; the binary chunk stays.
std::string EditedGlb(const std::string& bytes,
                      const std::function<void(nlohmann::json& root)>& edit) {
  GltfEvaluation gltf(bytes);
  edit(gltf.root);
  uint32_t length = 0;
  std::memcpy(&length, bytes.data() + 12, 4);
  FigureGltf packed{gltf.root, bytes.substr(20 + length + 8)};
  packed.root.erase("buffers");
  return PackFigureGltf(packed);
}

class GlbJointsTest : public testing::Test {
 protected:
  absl::StatusOr<Motion> MotionOf(const std::string& bytes) {
    PLEAT_ASSIGN_OR_RETURN(const std::optional<JointClip> clip,
                           DecodeGlbJoints(bytes, skeleton_, {}, {}, &report_));
    if (!clip) return absl::NotFoundError("no skin");
    return MotionFromClip(*clip, skeleton_);
  }

  const CharacterFile character_ = FigureCharacter(15);
  const Skeleton& skeleton_ = character_.rig.skeleton;
  const std::string bytes_ = EncodeCharacterGlb(character_).value();
  InputReport report_;
};

TEST_F(GlbJointsTest, WhatWasWrittenDrivesTheCharacterAsBefore) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const Motion motion, MotionOf(bytes_));
  EXPECT_LT(TrackDifference(motion.track, character_.track), 2e-6);  // float32
  EXPECT_DOUBLE_EQ(motion.track.fps(), 30000. / 1001);
  EXPECT_THAT(motion.warnings, IsEmpty());
  EXPECT_THAT(report_.notes, IsEmpty());
}

// As Blender writes it: joints in another order, axes along the bones, an armature above.
TEST_F(GlbJointsTest, OrderAxesAndArmatureOfAnotherProgramDoNotMatter) {
  const auto edit = [](nlohmann::json& root) {
    nlohmann::json& joints = root["skins"][0]["joints"];
    std::swap(joints[2], joints[9]);
    root["nodes"].push_back({{"name", "armature"},
                             {"scale", {.01, .01, .01}},
                             {"rotation", {.6, 0, 0, .8}},
                             {"children", {1}}});
    root["scenes"][0]["nodes"] = {0, root["nodes"].size() - 1};
  };
  // The inverse bind matrices do not follow the joints that were swapped: two are wrong then.
  EXPECT_THAT(MotionOf(EditedGlb(bytes_, edit)), HasStatus(kInvalid, HasSubstr("rest")));
  const auto whole_edit = [&](nlohmann::json& root) {
    edit(root);
    nlohmann::json& joints = root["skins"][0]["joints"];
    std::swap(joints[2], joints[9]);
  };
  PLEAT_ASSERT_OK_AND_ASSIGN(const Motion motion, MotionOf(EditedGlb(bytes_, whole_edit)));
  // The armature turns the world and shrinks it to centimeters, which the bones tell.
  EXPECT_EQ(motion.track.num_frames(), 15);
  const Eigen::Quaterniond turn(.8, .6, 0, 0);
  for (int t = 0; t < 15; ++t) {
    EXPECT_LT(motion.track.pose(t).rotations[0].angularDistance(
                  turn * character_.track.pose(t).rotations[0]),
              1e-5);
    EXPECT_LT(
        motion.track.pose(t).rotations[5].angularDistance(character_.track.pose(t).rotations[5]),
        1e-5);
  }
  EXPECT_THAT(motion.warnings, ElementsAre(HasSubstr("scaled")));
}

TEST_F(GlbJointsTest, KeysAtAnotherRateAreTheFramesOfTheMotion) {
  CharacterFile slow = character_;
  slow.frame_rate = {12, 1};
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::string bytes, EncodeCharacterGlb(slow));
  PLEAT_ASSERT_OK_AND_ASSIGN(const Motion motion, MotionOf(bytes));
  EXPECT_EQ(motion.track.fps(), 12);
  EXPECT_EQ(motion.track.num_frames(), 15);
}

TEST_F(GlbJointsTest, WithoutAnAnimationThereIsOneFrame) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::string bytes, EncodeCharacterGlb(FigureCharacter(0)));
  PLEAT_ASSERT_OK_AND_ASSIGN(const Motion motion, MotionOf(bytes));
  ASSERT_EQ(motion.track.num_frames(), 1);
  EXPECT_LT((motion.track.pose(0).root_position - skeleton_.rest_position(0)).norm(), 1e-6);
}

TEST_F(GlbJointsTest, OtherSkinsAreNone) {
  const auto rename = [](nlohmann::json& root) { root["nodes"][3]["name"] = "tail"; };
  EXPECT_THAT(MotionOf(EditedGlb(bytes_, rename)),
              HasStatus(absl::StatusCode::kNotFound, HasSubstr("no skin")));
}

TEST_F(GlbJointsTest, WhatIsNoRigidMotionIsRefused) {
  const auto mirror = [](nlohmann::json& root) { root["nodes"][1]["scale"] = {-1, 1, 1}; };
  EXPECT_THAT(MotionOf(EditedGlb(bytes_, mirror)), HasStatus(kInvalid, HasSubstr("'hips'")));
  const auto unbound = [](nlohmann::json& root) { root["skins"][0].erase("inverseBindMatrices"); };
  EXPECT_THAT(MotionOf(EditedGlb(bytes_, unbound)),
              HasStatus(kInvalid, HasSubstr("inverse bind matrices")));
}

TEST_F(GlbJointsTest, DamagedBytesAreReadOrRefused) {
  for (size_t i = 0; i < bytes_.size(); i += 7) {
    std::string damaged = bytes_;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x51);
    if (const absl::StatusOr<Motion> motion = MotionOf(damaged); motion.ok()) {
      EXPECT_GE(motion->track.num_frames(), 1);
    }
  }
  for (size_t length = 0; length < bytes_.size(); length += 101) {
    EXPECT_FALSE(MotionOf(bytes_.substr(0, length)).ok());
  }
}

}  // namespace
}  // namespace pleat
