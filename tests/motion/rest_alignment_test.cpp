#include "rest_alignment.h"

#include <gtest/gtest.h>

#include "motion/resting_clip.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

TEST(ShortestTurnTest, OneDirectionBecomesTheOther) {
  const Eigen::Vector3d from(1, 2, -.5), to(-3, .2, 1);
  const Eigen::Matrix3d turn = ShortestTurn(from, to);
  EXPECT_LT((turn * from.normalized() - to.normalized()).norm(), 1e-12);
  const Eigen::Vector3d across = from.cross(to);
  EXPECT_LT((turn * across - across).norm(), 1e-9) << "the axis turns too";
  EXPECT_LT((ShortestTurn(from, 2 * from) - Eigen::Matrix3d::Identity()).norm(), 1e-12);
  EXPECT_LT((ShortestTurn(from, -from) * from + from).norm(), 1e-9);
  EXPECT_TRUE(ShortestTurn(Eigen::Vector3d::Zero(), to).isIdentity());
}

class RestAlignmentTest : public testing::Test {
 protected:
  RestAlignment Align(const JointClip& clip) const {
    const JointMap map = MakeJointMap(clip, skeleton_).value();
    const std::vector<ResolvedBone> bones = ResolveJointMap(map, clip, skeleton_).value();
    return AlignRests({.clip = clip,
                       .skeleton = skeleton_,
                       .bones = bones,
                       .target = FindLandmarks(BodyJointsOf(skeleton_)),
                       .contacts = contacts_});
  }

  const CharacterFile character_ = FigureCharacter(20);
  const Skeleton& skeleton_ = character_.rig.skeleton;
  const JointClip clip_ = ClipFromPoses(skeleton_, character_.track);
  const std::array<FootContacts, 2> contacts_;
};

TEST_F(RestAlignmentTest, TheSameRestNeedsNoTurn) {
  const RestAlignment alignment = Align(clip_);
  EXPECT_TRUE(alignment.stands);
  for (const Eigen::Matrix3d& turn : alignment.turns) {
    EXPECT_LT((turn - Eigen::Matrix3d::Identity()).norm(), 1e-6);
  }
}

TEST_F(RestAlignmentTest, ABodyThatLiesAtRestDoesNotStand) {
  Pose lying = Pose::Rest(skeleton_);
  lying.rotations[0] = Eigen::AngleAxisd(1.5, Eigen::Vector3d::UnitX());
  EXPECT_FALSE(Align(WithRest(clip_, skeleton_, lying)).stands);
}

}  // namespace
}  // namespace pleat
