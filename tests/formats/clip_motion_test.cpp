#include "clip_motion.h"

#include "formats/figure_character.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class ClipMotionTest : public testing::Test {
 protected:
  const CharacterFile character_ = FigureCharacter(9);
  const Skeleton& skeleton_ = character_.rig.skeleton;
  JointClip clip_ = ClipFromPoses(skeleton_, character_.track);
};

TEST_F(ClipMotionTest, TheSameJointsGiveTheSamePoses) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const Motion motion, MotionFromClip(clip_, skeleton_));
  EXPECT_LT(TrackDifference(motion.track, character_.track), 1e-7);
  EXPECT_EQ(motion.track.fps(), character_.track.fps());
  EXPECT_THAT(motion.warnings, IsEmpty());
}

TEST_F(ClipMotionTest, AUnitIsFoundByTheBonesAndSaid) {
  for (ClipJoint& joint : clip_.joints) joint.offset *= 1 / .0254;
  for (Eigen::Vector3d& translation : clip_.translations) translation *= 1 / .0254;
  PLEAT_ASSERT_OK_AND_ASSIGN(const Motion motion, MotionFromClip(clip_, skeleton_));
  EXPECT_LT(TrackDifference(motion.track, character_.track), 1e-7);
  EXPECT_THAT(motion.warnings, ElementsAre(HasSubstr("in inches")));
}

TEST_F(ClipMotionTest, AnotherSizeIsScaledAndSaid) {
  for (ClipJoint& joint : clip_.joints) joint.offset *= 1.3;
  for (Eigen::Vector3d& translation : clip_.translations) translation *= 1.3;
  PLEAT_ASSERT_OK_AND_ASSIGN(const Motion motion, MotionFromClip(clip_, skeleton_));
  EXPECT_LT(TrackDifference(motion.track, character_.track), 1e-7);
  EXPECT_THAT(motion.warnings, ElementsAre(HasSubstr("scaled by 0.7692")));
}

// The same motion in a world whose Z points up: the body is turned, and so is every turn.
TEST_F(ClipMotionTest, ATurnedWorldIsTurnedBackAndSaid) {
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(EIGEN_PI / 2, Eigen::Vector3d::UnitX()));
  for (ClipJoint& joint : clip_.joints) joint.offset = turn * joint.offset;
  for (Eigen::Vector3d& translation : clip_.translations) translation = turn * translation;
  for (Eigen::Quaterniond& rotation : clip_.rotations) {
    rotation = turn * rotation * turn.conjugate();
  }
  PLEAT_ASSERT_OK_AND_ASSIGN(const Motion motion, MotionFromClip(clip_, skeleton_));
  EXPECT_LT(TrackDifference(motion.track, character_.track), 1e-7);
  EXPECT_THAT(motion.warnings, ElementsAre(HasSubstr("turned by 90.0 degrees")));
}

TEST_F(ClipMotionTest, MissingJointsAreNamed) {
  clip_.joints[static_cast<size_t>(clip_.FindJoint("head"))].name = "skull\n";
  EXPECT_THAT(MotionFromClip(clip_, skeleton_),
              HasStatus(kInvalid, AllOf(HasSubstr("lacks head"), HasSubstr("skull\\x0a"))));
}

TEST_F(ClipMotionTest, AnotherOrderOfTheHierarchyIsNamed) {
  const int hand = clip_.FindJoint("leftHand"), head = clip_.FindJoint("head");
  std::swap(clip_.joints[hand].name, clip_.joints[head].name);
  EXPECT_THAT(MotionFromClip(clip_, skeleton_),
              HasStatus(kInvalid, HasSubstr("does not hang below")));
}

TEST_F(ClipMotionTest, AnotherRestPoseIsRefusedWithTheJoint) {
  const int hand = clip_.FindJoint("leftHand");
  clip_.joints[hand].offset += Eigen::Vector3d(0, .4, 0);
  EXPECT_THAT(MotionFromClip(clip_, skeleton_),
              HasStatus(kInvalid, AllOf(HasSubstr("'leftHand' rests"), HasSubstr("meters"))));
}

TEST_F(ClipMotionTest, JointsInOnePlaceAreRefused) {
  for (ClipJoint& joint : clip_.joints) joint.offset.setZero();
  EXPECT_THAT(MotionFromClip(clip_, skeleton_), HasStatus(kInvalid, HasSubstr("one place")));
}

TEST_F(ClipMotionTest, BonesKeepTheirLengthsAndSaySo) {
  const size_t hand = static_cast<size_t>(clip_.FindJoint("leftHand"));
  clip_.translations[4 * clip_.num_joints() + hand] *= 1.5;
  PLEAT_ASSERT_OK_AND_ASSIGN(const Motion motion, MotionFromClip(clip_, skeleton_));
  EXPECT_LT(TrackDifference(motion.track, character_.track), 1e-7);
  EXPECT_THAT(motion.warnings, ElementsAre(AllOf(HasSubstr("'leftHand'"), HasSubstr("frame 4"))));
}

// As skeletons of other programs have it: one rotation for all bones of a joint.
TEST_F(ClipMotionTest, WithoutJointsOfBonesAllBonesOfAJointTurnAlike) {
  JointClip plain;
  std::vector<int> new_index(clip_.num_joints(), -1);
  for (size_t j = 0; j < clip_.num_joints(); ++j) {
    if (clip_.joints[j].name.ends_with("_bone")) continue;
    new_index[j] = static_cast<int>(plain.joints.size());
    ClipJoint joint = clip_.joints[j];
    while (joint.parent >= 0 && new_index[joint.parent] < 0) {
      joint.parent = clip_.joints[joint.parent].parent;
    }
    if (joint.parent >= 0) joint.parent = new_index[joint.parent];
    plain.joints.push_back(joint);
    plain.translations.push_back(joint.offset);
    plain.rotations.push_back(Eigen::Quaterniond::Identity());
  }
  const int chest = plain.FindJoint("chest");
  plain.rotations[chest] = Eigen::AngleAxisd(.5, Eigen::Vector3d::UnitY());
  PLEAT_ASSERT_OK_AND_ASSIGN(const Motion motion, MotionFromClip(plain, skeleton_));
  const Pose& pose = motion.track.pose(0);
  for (const char* bone : {"head", "leftUpperArm", "rightUpperArm"}) {
    EXPECT_LT(pose.rotations[skeleton_.FindJoint(bone)].angularDistance(plain.rotations[chest]),
              1e-7)
        << bone;
  }
  EXPECT_LT(pose.rotations[skeleton_.FindJoint("leftLowerArm")].angularDistance(
                Eigen::Quaterniond::Identity()),
            1e-7);
}

TEST_F(ClipMotionTest, SignsOfRotationsDoNotJump) {
  for (size_t i = 0; i < clip_.rotations.size(); i += 3) clip_.rotations[i].coeffs() *= -1;
  PLEAT_ASSERT_OK_AND_ASSIGN(const Motion motion, MotionFromClip(clip_, skeleton_));
  for (int t = 1; t < motion.track.num_frames(); ++t) {
    for (int j = 0; j < skeleton_.num_joints(); ++j) {
      EXPECT_GE(motion.track.pose(t).rotations[j].dot(motion.track.pose(t - 1).rotations[j]), 0);
    }
  }
}

}  // namespace
}  // namespace pleat
