#include "pleat/motion/apply_edits.h"

#include <gmock/gmock.h>

#include "formats/figure_character.h"
#include "support/hostile_bytes.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class ApplyEditsTest : public testing::Test {
 protected:
  ApplyEditsTest() {
    motion_.track = character_.track;
    text_ = EncodeMotionWithSkeleton(skeleton_, motion_);
  }
  Motion Apply(const MotionEdit& edit) const { return *ApplyEdit(skeleton_, motion_, edit); }

  // One edit of each kind.
  std::vector<MotionEdit> OneOfEach() const {
    return {
        {.kind = EditKind::kOffsetRotation, .joints = {"head"}, .numbers = {{0, 20, 0}}},
        {.kind = EditKind::kScaleRotation, .joints = {"all"}, .numbers = {{.5}}},
        {.kind = EditKind::kOffsetRoot, .numbers = {{0, .1, 0}}},
        {.kind = EditKind::kLimit, .joints = {"leftHand", "rightHand"}, .numbers = {{20}, {5}}},
        {.kind = EditKind::kMirror},
        {.kind = EditKind::kSmooth, .joints = {"all", "hips"}, .numbers = {{.1}}},
        {.kind = EditKind::kTimeScale, .numbers = {{1.5}}},
        {.kind = EditKind::kTimeWarp, .numbers = {{0, .2, .6}, {0, .5, .8}}},
        {.kind = EditKind::kResample, .numbers = {{24}}},
        {.kind = EditKind::kTrim, .numbers = {{.1}, {.7}}},
        {.kind = EditKind::kLoop, .numbers = {{.2}, {3}}},
        {.kind = EditKind::kBlend, .joints = {"all"}, .numbers = {{.3}}, .other = text_},
        {.kind = EditKind::kConcatenate, .numbers = {{.2}}, .other = text_},
        {.kind = EditKind::kBoneScale, .joints = {"leftFoot"}, .numbers = {{1.2}}},
        {.kind = EditKind::kDetail, .joints = {"all"}, .numbers = {{1.5}}},
        {.kind = EditKind::kVertexDetail, .numbers = {{0, .25, 2, 1.123456}}},
        {.kind = EditKind::kCleanFeet},
    };
  }

  const CharacterFile character_ = FigureCharacter(30);
  const Skeleton& skeleton_ = character_.rig.skeleton;
  Motion motion_;
  std::string text_;
};

TEST_F(ApplyEditsTest, EveryEditUndoneIsTheFileBefore) {
  const std::vector<MotionEdit> edits = OneOfEach();
  ASSERT_EQ(edits.size(), EditForms().size());
  std::vector<std::string> files = {text_};
  for (const MotionEdit& edit : edits) {
    absl::StatusOr<std::string> next = AddEdit(skeleton_, files.back(), edit);
    ASSERT_TRUE(next.ok()) << FormOf(edit.kind).name << ": " << next.status();
    EXPECT_NE(*next, files.back());
    files.push_back(*std::move(next));
  }
  std::string text = files.back();
  for (size_t i = files.size() - 1; i-- > 0;) {
    PLEAT_ASSERT_OK_AND_ASSIGN(text, UndoEdits(text, 1));
    EXPECT_TRUE(text == files[i]) << i;
  }
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::string all,
                             UndoEdits(files.back(), static_cast<int>(edits.size())));
  EXPECT_TRUE(all == text_);
  EXPECT_THAT(UndoEdits(text_, 1), HasStatus(kInvalid, HasSubstr("has 0 edits")));
}

// Whatever wrote the source, its own bytes come back.
TEST_F(ApplyEditsTest, TheBytesOfTheSourceAreKept) {
  const std::string source =
      "\n {\"fps\": 25.0, \"schema\":\"pleat.motion/1\",\t\"note\": \"\\u00e4 \xc3\xa4\","
      "\"joints\": [\"hips\"], \"root_translation\": [[0,1e0,0]],"
      "\"rotations\": [[[2,0,0,0]]]}\r\n\n";
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::string edited,
                             AddEdit(skeleton_, source, {.kind = EditKind::kMirror}));
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::string back, UndoEdits(edited, 1));
  EXPECT_EQ(back, source);
}

TEST_F(ApplyEditsTest, AnEditedFileIsAMotionToThoseWhoPlayIt) {
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const std::string edited,
      AddEdit(skeleton_, text_,
              {.kind = EditKind::kDetail, .joints = {"leftHand"}, .numbers = {{.5}}}));
  PLEAT_ASSERT_OK_AND_ASSIGN(const Motion motion, DecodeMotion(edited, skeleton_));
  EXPECT_TRUE(motion.warnings.empty());
  EXPECT_EQ(motion.detail_strengths[kLeftHand], .5);
  EXPECT_EQ(motion.detail_strengths[kHead], 1);
  EXPECT_LT(TrackDifference(motion.track, motion_.track), 1e-12);
}

TEST_F(ApplyEditsTest, MirroredTwiceIsTheSame) {
  Motion with_scales = motion_;
  with_scales.bone_scales.assign(18, 1);
  with_scales.bone_scales[kLeftHand] = 1.3;
  const MotionEdit mirror{.kind = EditKind::kMirror};
  PLEAT_ASSERT_OK_AND_ASSIGN(const Motion once, ApplyEdit(skeleton_, with_scales, mirror));
  EXPECT_EQ(once.bone_scales[kRightHand], 1.3);
  EXPECT_EQ(once.bone_scales[kLeftHand], 1);
  EXPECT_GT(TrackDifference(once.track, motion_.track), .1);
  PLEAT_ASSERT_OK_AND_ASSIGN(const Motion twice, ApplyEdit(skeleton_, once, mirror));
  EXPECT_LT(TrackDifference(twice.track, motion_.track), 1e-12);
  EXPECT_EQ(twice.bone_scales, with_scales.bone_scales);
  // The template is symmetric, so joints are where those of the other side were, in a mirror.
  BoneTransforms a, b;
  ComputeBoneTransforms(skeleton_, motion_.track.pose(7), {}, &a);
  ComputeBoneTransforms(skeleton_, once.track.pose(7), {}, &b);
  const double middle = motion_.track.pose(0).root_position.x();
  for (int j = 0; j < 18; ++j) {
    Eigen::Vector3d expected = a.joint_positions.col(HumanMirror()[static_cast<size_t>(j)]);
    expected.x() = 2 * middle - expected.x();
    EXPECT_LT((b.joint_positions.col(j) - expected).norm(), 1e-9) << j;
  }
}

TEST_F(ApplyEditsTest, LimitsHoldAndLeaveWhatIsWithinThemAlone) {
  const Motion limited =
      Apply({.kind = EditKind::kLimit, .joints = {"leftHand"}, .numbers = {{15}, {180}}});
  const Eigen::Vector3d bone =
      skeleton_.rest_position(kLeftHand) - skeleton_.rest_position(kLeftLowerArm);
  bool was_beyond = false;
  for (int t = 0; t < motion_.track.num_frames(); ++t) {
    const auto angle = [&](const Motion& motion) {
      const Eigen::Vector3d turned = motion.track.pose(t).rotations[kLeftHand] * bone;
      return std::acos(std::clamp(turned.dot(bone) / bone.squaredNorm(), -1., 1.)) * 180 / M_PI;
    };
    EXPECT_LT(angle(limited), 15.001);
    was_beyond = was_beyond || angle(motion_) > 16;
    if (angle(motion_) < 14.9) {
      EXPECT_NEAR(angle(limited), angle(motion_), 1e-6);
    }
  }
  EXPECT_TRUE(was_beyond);
  const Motion wide =
      Apply({.kind = EditKind::kLimit, .joints = {"all"}, .numbers = {{180}, {180}}});
  EXPECT_EQ(TrackDifference(wide.track, motion_.track), 0);
}

TEST_F(ApplyEditsTest, SmoothingKeepsWhatIsStillAndCalmsWhatShakes) {
  Motion shaking = motion_;
  PoseTrack::Parts parts{.fps = 30};
  for (int t = 0; t < 40; ++t) {
    parts.poses.push_back(Pose::Rest(skeleton_));
    parts.poses.back().rotations[kHead] =
        Eigen::AngleAxisd(t % 2 == 0 ? .2 : -.2, Eigen::Vector3d::UnitY());
  }
  shaking.track = *PoseTrack::Create(std::move(parts));
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const Motion calm,
      ApplyEdit(skeleton_, shaking,
                {.kind = EditKind::kSmooth, .joints = {"all"}, .numbers = {{.2}}}));
  EXPECT_LT(calm.track.pose(20).rotations[kHead].angularDistance(Eigen::Quaterniond::Identity()),
            .01);
  EXPECT_LT(calm.track.pose(20).rotations[kChest].angularDistance(Eigen::Quaterniond::Identity()),
            1e-12);
}

TEST_F(ApplyEditsTest, TimesAreWhereTheKeysSay) {
  const Motion same = Apply({.kind = EditKind::kTimeWarp, .numbers = {{0, .4, .9}, {0, .4, .9}}});
  for (int t = 0; t < same.track.num_frames(); ++t) {
    EXPECT_LT((same.track.pose(t).root_position - motion_.track.pose(t).root_position).norm(),
              1e-9);
  }
  const double fps = motion_.track.fps();
  const Motion warped = Apply(
      {.kind = EditKind::kTimeWarp, .numbers = {{0, 10 / fps, 20 / fps}, {0, 20 / fps, 25 / fps}}});
  EXPECT_EQ(warped.track.num_frames(), 26);
  EXPECT_LT((warped.track.pose(20).root_position - motion_.track.pose(10).root_position).norm(),
            1e-9);
  EXPECT_LT((warped.track.pose(25).root_position - motion_.track.pose(20).root_position).norm(),
            1e-9);
  const Motion trimmed = Apply({.kind = EditKind::kTrim, .numbers = {{4 / fps}, {9 / fps}}});
  EXPECT_EQ(trimmed.track.num_frames(), 6);
  EXPECT_EQ(trimmed.track.pose(0).root_position, motion_.track.pose(4).root_position);
  EXPECT_EQ(Apply({.kind = EditKind::kResample, .numbers = {{60}}}).track.fps(), 60);
}

// The largest step of any bone in the world between two frames, radians.
double LargestStep(const Skeleton& skeleton, const PoseTrack& track) {
  double largest = 0;
  BoneTransforms a, b;
  for (int t = 1; t < track.num_frames(); ++t) {
    ComputeBoneTransforms(skeleton, track.pose(t - 1), {}, &a);
    ComputeBoneTransforms(skeleton, track.pose(t), {}, &b);
    largest =
        std::max(largest, (a.joint_positions - b.joint_positions).colwise().norm().maxCoeff());
  }
  return largest;
}

TEST_F(ApplyEditsTest, LoopsAndTransitionsDoNotJump) {
  const double before = LargestStep(skeleton_, motion_.track);
  const Motion looped = Apply({.kind = EditKind::kLoop, .numbers = {{.4}, {3}}});
  EXPECT_EQ(looped.track.num_frames(), 3 * 29 + 1);
  EXPECT_LT(LargestStep(skeleton_, looped.track), 4 * before);
  // Each round ends in the pose in which it began, wherever it stands.
  for (size_t j = 1; j < 18; ++j) {
    EXPECT_LT(looped.track.pose(0).rotations[j].angularDistance(looped.track.pose(29).rotations[j]),
              1e-9);
  }
  EXPECT_NEAR(looped.track.pose(0).root_position.y(), looped.track.pose(29).root_position.y(),
              1e-9);
  const Motion joined = Apply({.kind = EditKind::kConcatenate, .numbers = {{.5}}, .other = text_});
  EXPECT_EQ(joined.track.num_frames(), 30 + 29 - 15);
  EXPECT_LT(LargestStep(skeleton_, joined.track), 4 * before);
  EXPECT_EQ(joined.track.pose(5).root_position, motion_.track.pose(5).root_position);
}

TEST_F(ApplyEditsTest, BlendsGoFromOneToTheOther) {
  Motion other = motion_;
  other.track = MakeSmoothPoses(skeleton_, 45, 8);
  const std::string text = EncodeMotion(skeleton_, other.track);
  const auto blend = [&](double weight, std::vector<std::string> joints) {
    return Apply(
        {.kind = EditKind::kBlend, .joints = joints, .numbers = {{weight}}, .other = text});
  };
  EXPECT_LT(TrackDifference(blend(0, {"all"}).track, motion_.track), 1e-9);
  const Motion whole = blend(1, {"all"}), arm = blend(1, {"leftHand"});
  EXPECT_EQ(whole.track.num_frames(), 30);
  EXPECT_LT(
      whole.track.pose(29).rotations[kHead].angularDistance(other.track.pose(44).rotations[kHead]),
      1e-9);
  EXPECT_LT((whole.track.pose(0).root_position - motion_.track.pose(0).root_position)
                .cwiseProduct(Eigen::Vector3d(1, 0, 1))
                .norm(),
            1e-9);
  EXPECT_EQ(arm.track.pose(9).root_position, motion_.track.pose(9).root_position);
  EXPECT_GT(arm.track.pose(9).rotations[kLeftHand].angularDistance(
                motion_.track.pose(9).rotations[kLeftHand]),
            .01);
}

TEST_F(ApplyEditsTest, WhatAnEditCannotDoIsSaid) {
  EXPECT_THAT(ApplyEdit(skeleton_, motion_,
                        {.kind = EditKind::kDetail, .joints = {"tail"}, .numbers = {{1}}}),
              HasStatus(kInvalid, AllOf(HasSubstr("detail: "), HasSubstr("no joint 'tail'"))));
  EXPECT_THAT(ApplyEdit(skeleton_, motion_, {.kind = EditKind::kTrim, .numbers = {{90}, {99}}}),
              HasStatus(kInvalid, HasSubstr("no frame is between")));
  EXPECT_THAT(
      ApplyEdit(skeleton_, motion_, {.kind = EditKind::kTimeWarp, .numbers = {{0, .5}, {1, 1}}}),
      HasStatus(kInvalid, HasSubstr("must ascend")));
  EXPECT_THAT(
      ApplyEdit(skeleton_, motion_,
                {.kind = EditKind::kBlend, .joints = {"all"}, .numbers = {{1}}, .other = "{}"}),
      HasStatus(kInvalid, HasSubstr("the other motion")));
  Motion clips = motion_;
  PoseTrack::Parts parts = motion_.track.parts();
  parts.clip_starts = {0, 10};
  clips.track = *PoseTrack::Create(std::move(parts));
  EXPECT_THAT(ApplyEdit(skeleton_, clips, {.kind = EditKind::kLoop, .numbers = {{.1}, {2}}}),
              HasStatus(kInvalid, HasSubstr("2 clips")));
  EXPECT_THAT(ApplyEdit(skeleton_, motion_, {.kind = EditKind::kLoop, .numbers = {{0}, {1000}}})
                  .status()
                  .code(),
              absl::StatusCode::kOk);
  Motion longer = Apply({.kind = EditKind::kTimeScale, .numbers = {{100}}});
  EXPECT_THAT(ApplyEdit(skeleton_, longer, {.kind = EditKind::kTimeScale, .numbers = {{100}}}),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("the limit is")));
}

TEST_F(ApplyEditsTest, DamagedFilesAreRefusedOrRead) {
  Motion short_motion = motion_;
  short_motion.track = motion_.track.Subset({0, 1});
  std::string text = EncodeMotionWithSkeleton(skeleton_, short_motion);
  PLEAT_ASSERT_OK_AND_ASSIGN(
      text, AddEdit(skeleton_, text, {.kind = EditKind::kOffsetRoot, .numbers = {{0, 1, 0}}}));
  PLEAT_ASSERT_OK_AND_ASSIGN(text, AddEdit(skeleton_, text, {.kind = EditKind::kMirror}));
  size_t step = 0;
  const auto try_undo = [&](const std::string& damaged) {
    if (++step % 97 == 0) (void)UndoEdits(damaged, 1);
  };
  ForEachTruncation(text, try_undo);
  ForEachCorruption(text, try_undo);
}

}  // namespace
}  // namespace pleat
