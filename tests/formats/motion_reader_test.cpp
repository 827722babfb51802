#include "pleat/formats/motion_reader.h"

#include "formats/figure_character.h"
#include "formats/figure_glb.h"
#include "pleat/base/file.h"
#include "pleat/formats/bvh.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class MotionReaderTest : public testing::Test {
 protected:
  std::string Write(const std::string& name, const std::string& bytes) const {
    EXPECT_THAT(WriteFile(folder_.File(name), bytes), IsOk());
    return folder_.File(name);
  }
  std::string Json() const { return EncodeMotion(skeleton_, character_.track); }
  std::string Bvh() const { return EncodeBvh(ClipFromPoses(skeleton_, character_.track)); }
  std::string Glb() const { return EncodeCharacterGlb(character_).value(); }

  const TemporaryFolder folder_;
  const CharacterFile character_ = FigureCharacter(6);
  const Skeleton& skeleton_ = character_.rig.skeleton;
};

TEST_F(MotionReaderTest, EveryFormIsTheSameMotion) {
  for (const std::string& path :
       {Write("m.json", Json()), Write("m.bvh", Bvh()), Write("m.glb", Glb())}) {
    PLEAT_ASSERT_OK_AND_ASSIGN(const Motion motion, ReadMotion(path, skeleton_));
    EXPECT_LT(TrackDifference(motion.track, character_.track), 2e-6) << path;
    EXPECT_NEAR(motion.track.fps(), character_.track.fps(), 1e-9) << path;
    EXPECT_TRUE(HoldsMotion(path, skeleton_)) << path;
  }
}

TEST_F(MotionReaderTest, WhatTheBytesAreCountsMoreThanTheEnding) {
  for (const std::string& bytes : {Json(), Bvh(), Glb()}) {
    const std::string path = Write("m.txt", bytes);
    EXPECT_THAT(ReadMotion(path, skeleton_), IsOk());
    EXPECT_FALSE(HoldsMotion(path, skeleton_));
  }
}

TEST_F(MotionReaderTest, ErrorsNameTheFile) {
  EXPECT_THAT(ReadMotion(Write("bad.bvh", "x"), skeleton_),
              HasStatus(kInvalid, AllOf(HasSubstr("bad.bvh"), HasSubstr("HIERARCHY"))));
  EXPECT_THAT(ReadMotion(Write("bad.json", "x"), skeleton_),
              HasStatus(kInvalid, AllOf(HasSubstr("bad.json"), HasSubstr("JSON"))));
  EXPECT_THAT(ReadMotion(folder_.File("none.bvh"), skeleton_),
              HasStatus(absl::StatusCode::kNotFound, HasSubstr("none.bvh")));
}

TEST_F(MotionReaderTest, AnotherSkinIsNoMotionAndSaysWhichJointsItNeeds) {
  const Skeleton other = *Skeleton::Create({{"a", -1, {0, 0, 0}}, {"b", 0, {0, 1, 0}}});
  const std::string path = Write("m.glb", Glb());
  EXPECT_FALSE(HoldsMotion(path, other));
  EXPECT_THAT(ReadMotion(path, other), HasStatus(kInvalid, HasSubstr("which are a, b")));
  EXPECT_THAT(ReadMotion(Write("m.bvh", Bvh()), other),
              HasStatus(kInvalid, HasSubstr("lacks a, b; it has hips, ")));
}

TEST_F(MotionReaderTest, AStillSkinIsNoMotion) {
  const std::string path = Write("s.glb", EncodeCharacterGlb(FigureCharacter(0)).value());
  EXPECT_FALSE(HoldsMotion(path, skeleton_));
  EXPECT_THAT(ReadMotion(path, skeleton_), IsOk());
}

}  // namespace
}  // namespace pleat
