#include "pleat/motion/retarget.h"

#include <gmock/gmock.h>

#include "motion/resting_clip.h"
#include "pleat/formats/joint_clip_reader.h"
#include "pleat/motion/clean_feet.h"
#include "pleat/motion/default_joint_map.h"
#include "support/shared_data.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using testing::HasSubstr;

class RetargetTest : public testing::Test {
 protected:
  // Feet of this figure do not stand anywhere, so they point where the clip's do.
  JointMap MapOf(const JointClip& clip) const {
    JointMap map = *MakeJointMap(clip, skeleton_);
    for (JointMapEntry& entry : map.joints) {
      if (entry.alignment == BoneAlignment::kSole) entry.alignment = BoneAlignment::kDirection;
    }
    return map;
  }
  void ExpectTruth(const JointClip& clip) const {
    RetargetReport report;
    PLEAT_ASSERT_OK_AND_ASSIGN(const PoseTrack track, Retarget(clip, MapOf(clip), skeleton_,
                                                               {.on_floor = false}, &report));
    EXPECT_TRUE(report.rest_stands);
    EXPECT_EQ(track.fps(), clip.fps);
    EXPECT_LT(TrackDifference(track, character_.track), 1e-6);
  }
  Pose TPose() const {
    Pose pose = Pose::Rest(skeleton_);
    Swing(skeleton_, "leftLowerArm", Eigen::Vector3d::UnitX(), &pose);
    Swing(skeleton_, "rightLowerArm", -Eigen::Vector3d::UnitX(), &pose);
    return pose;
  }

  const CharacterFile character_ = FigureCharacter(25);
  const Skeleton& skeleton_ = character_.rig.skeleton;
  const JointClip clip_ = ClipFromPoses(skeleton_, character_.track);
};

TEST_F(RetargetTest, TheSameSkeletonGivesTheSameMotion) { ExpectTruth(clip_); }

TEST_F(RetargetTest, ATPoseIsSolvedExactly) { ExpectTruth(WithRest(clip_, skeleton_, TPose())); }

TEST_F(RetargetTest, AnAPoseWithBentElbowsAndStraddledLegsIsSolvedExactly) {
  Pose pose = Pose::Rest(skeleton_);
  Swing(skeleton_, "leftLowerArm", {1, -1, .2}, &pose);
  Swing(skeleton_, "rightLowerArm", {-1, -.8, .1}, &pose);
  Swing(skeleton_, "leftLowerLeg", {.3, -1, 0}, &pose);
  Swing(skeleton_, "rightLowerLeg", {-.25, -1, .1}, &pose);
  Swing(skeleton_, "leftFoot", {0, -1, -.1}, &pose);
  ExpectTruth(WithRest(clip_, skeleton_, pose));
}

TEST_F(RetargetTest, ARestThatFacesElsewhereIsTurned) {
  Pose pose = TPose();
  pose.rotations[0] = Eigen::AngleAxisd(2, Eigen::Vector3d::UnitY());
  ExpectTruth(WithRest(clip_, skeleton_, pose));
}

TEST_F(RetargetTest, UnitsAndAWorldWithZUpAreFound) {
  JointClip clip = WithRest(clip_, skeleton_, TPose());
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(EIGEN_PI / 2, Eigen::Vector3d::UnitX()));
  for (ClipJoint& joint : clip.joints) joint.offset = turn * (100 * joint.offset);
  for (Eigen::Vector3d& place : clip.translations) place = turn * (100 * place);
  for (Eigen::Quaterniond& rotation : clip.rotations) {
    rotation = turn * rotation * turn.conjugate();
  }
  JointMap map = MapOf(clip);
  map.up = ClipUp::kZ;  // this figure tumbles, so its mean says nothing
  RetargetReport report;
  PLEAT_ASSERT_OK_AND_ASSIGN(const PoseTrack track,
                             Retarget(clip, map, skeleton_, {.on_floor = false}, &report));
  EXPECT_EQ(report.unit.name, "centimeters");
  EXPECT_NEAR(report.scale, .01, 1e-9);
  EXPECT_LT(TrackDifference(track, character_.track), 1e-6);
}

// A forearm in two pieces, of which the second one has the twist.
TEST_F(RetargetTest, TwistJointsAreCollapsed) {
  JointClip clip = clip_;
  const int hand = clip.FindJoint("leftHand");
  const size_t num_joints = clip.num_joints();
  JointClip split{.fps = clip.fps};
  split.joints = clip.joints;
  ClipJoint twist = clip.joints[hand];
  twist.name = "leftForeArmRoll";
  twist.offset *= .5;
  split.joints.insert(split.joints.begin() + hand, twist);
  split.joints[hand + 1].offset *= .5;
  for (size_t j = hand + 1; j < split.joints.size(); ++j) {
    int& parent = split.joints[j].parent;
    if (static_cast<int>(j) == hand + 1) {
      parent = hand;
    } else if (parent >= hand) {
      ++parent;
    }
  }
  const Eigen::Vector3d axis = twist.offset.normalized();
  for (size_t t = 0; t < clip.num_frames(); ++t) {
    for (size_t j = 0; j < num_joints; ++j) {
      if (static_cast<int>(j) == hand) {
        split.rotations.emplace_back(Eigen::AngleAxisd(.02 * static_cast<double>(t), axis));
        split.translations.push_back(twist.offset);
      }
      split.rotations.push_back(clip.rotations[t * num_joints + j]);
      split.translations.push_back(
          static_cast<int>(j) == hand ? twist.offset : clip.translations[t * num_joints + j]);
    }
  }
  RetargetReport report;
  const JointMap map = MapOf(split);
  PLEAT_ASSERT_OK_AND_ASSIGN(const PoseTrack track,
                             Retarget(split, map, skeleton_, {.on_floor = false}, &report));
  for (int t = 0; t < track.num_frames(); ++t) {
    const Eigen::Quaterniond expected =
        character_.track.pose(t).rotations[kLeftHand] * Eigen::AngleAxisd(.02 * t, axis);
    EXPECT_LT(track.pose(t).rotations[kLeftHand].angularDistance(expected), 1e-6) << t;
    EXPECT_LT(track.pose(t).rotations[kLeftLowerArm].angularDistance(
                  character_.track.pose(t).rotations[kLeftLowerArm]),
              1e-6);
  }
}

// The size of the body changes, and with it how far it goes.
TEST_F(RetargetTest, PlacesAreScaledByTheLegs) {
  const Skeleton larger = skeleton_.WithRestPositions(1.25 * skeleton_.RestPositions());
  RetargetReport report;
  PLEAT_ASSERT_OK_AND_ASSIGN(const PoseTrack track,
                             Retarget(clip_, MapOf(clip_), larger, {.on_floor = false}, &report));
  EXPECT_NEAR(report.scale, 1.25, 1e-12);
  for (int t = 0; t < track.num_frames(); ++t) {
    EXPECT_LT((track.pose(t).root_position - 1.25 * character_.track.pose(t).root_position).norm(),
              1e-6);
  }
}

TEST_F(RetargetTest, ABoneThatIsNotDrivenFollowsTheOneAbove) {
  JointMap map = MapOf(clip_);
  map.joints[kLeftHand].from.clear();
  map.joints[kLeftHand].turns_with.clear();
  RetargetReport report;
  PLEAT_ASSERT_OK_AND_ASSIGN(const PoseTrack track, Retarget(clip_, map, skeleton_, {}, &report));
  EXPECT_LT(track.pose(7).rotations[kLeftHand].angularDistance(Eigen::Quaterniond::Identity()),
            1e-9);
}

TEST_F(RetargetTest, MapsThatDoNotFitAreRefusedWithTheJoint) {
  RetargetReport report;
  const auto expect = [&](auto damage, const char* reason) {
    JointMap map = MapOf(clip_);
    damage(map);
    EXPECT_THAT(Retarget(clip_, map, skeleton_, {}, &report),
                HasStatus(kInvalid, HasSubstr(reason)));
  };
  expect([](JointMap& m) { m.joints[3].from = "skull\n"; }, "'skull\\x0a' is no joint of the clip");
  expect([](JointMap& m) { m.joints[3].joint = "skull"; }, "has no joint 'skull'");
  expect([](JointMap& m) { m.joints[kLeftFoot].from.clear(); }, "must drive hips, both legs");
  expect([](JointMap& m) { m.joints.erase(m.joints.begin()); }, "the root 'hips'");
  expect([](JointMap& m) { m.joints.clear(); }, "the root 'hips'");
  JointClip flat = clip_;
  for (ClipJoint& joint : flat.joints) joint.offset.setZero();
  EXPECT_THAT(Retarget(flat, MapOf(clip_), skeleton_, {}, &report),
              HasStatus(kInvalid, HasSubstr("no length")));
}

// Real clips: rests with arms down, as a T-pose, and with bones along x; several units.
TEST_F(RetargetTest, AllSharedClipsStandOnTheFloorAndBendTheirKneesForward) {
  for (const char* name :
       {"131_01", "131_02", "01_01", "Boxing_Toes", "bandai_walk_normal", "jesse_dance"}) {
    PLEAT_SHARED_DATA_OR_SKIP(path, std::string("bvh/") + name + ".bvh");
    PLEAT_ASSERT_OK_AND_ASSIGN(const JointClipFile file, ReadJointClip(path));
    PLEAT_ASSERT_OK_AND_ASSIGN(const JointMap map, MakeJointMap(file.clip, skeleton_));
    RetargetReport report;
    PLEAT_ASSERT_OK_AND_ASSIGN(const PoseTrack track,
                               Retarget(file.clip, map, skeleton_, {}, &report));
    CleanFeetSummary summary;
    PLEAT_ASSERT_OK_AND_ASSIGN(const PoseTrack clean,
                               CleanFeet(skeleton_, track, report.contacts, {}, &summary));
    EXPECT_LT(summary.after.mean_mm, .25 * summary.before.mean_mm) << name;
    BoneTransforms transforms;
    int backward = 0, below = 0;
    for (const Pose& pose : clean.poses()) {
      ComputeBoneTransforms(skeleton_, pose, {}, &transforms);
      const Eigen::Matrix3Xd& at = transforms.joint_positions;
      for (const int hip : {kLeftUpperLeg, kRightUpperLeg}) {
        const Eigen::Vector3d thigh = at.col(hip + 1) - at.col(hip);
        const Eigen::Vector3d shank = at.col(hip + 2) - at.col(hip + 1);
        const Eigen::Vector3d left = transforms.rotation[static_cast<size_t>(hip + 1)].col(0);
        const double bend = thigh.normalized().cross(shank.normalized()).dot(left);
        if (bend < -.25) ++backward;  // captured knees are up to some degrees past straight
        if (at(1, hip + 3) < .5 * skeleton_.rest_position(hip + 3).y() - .02) ++below;
      }
    }
    EXPECT_LE(backward, track.num_frames() / 100) << name;
    EXPECT_LE(below, track.num_frames() / 50) << name;
  }
}

}  // namespace
}  // namespace pleat
