#include "pleat/character/placed_joints.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "pleat/skeleton/human_template.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

TEST(PlacedJoints, AreReadByNameAndPosition) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::vector<PlacedJoint> placed,
                             ParsePlacedJoints(" leftHand=.5,-1e-1,2  hips=0,1,0"));
  ASSERT_EQ(placed.size(), 2u);
  EXPECT_EQ(placed[0].joint, kLeftHand);
  EXPECT_EQ(placed[0].position, Eigen::Vector3d(.5, -.1, 2));
  EXPECT_EQ(placed[1].joint, kHips);
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::vector<PlacedJoint> none, ParsePlacedJoints(""));
  EXPECT_TRUE(none.empty());
}

TEST(PlacedJoints, TheTextRestoresEveryPositionExactly) {
  const std::vector<PlacedJoint> placed = {{kHead, {.1, 1. / 3, -1e-7}},
                                           {kRightFoot, {5, 0, 123456.789012345}}};
  EXPECT_THAT(FormatPlacedJoints(placed), HasSubstr("rightFoot=5,0,123456.789012345"));
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::vector<PlacedJoint> back,
                             ParsePlacedJoints(FormatPlacedJoints(placed)));
  EXPECT_EQ(back, placed);
  EXPECT_EQ(FormatPlacedJoints({}), "");
}

TEST(PlacedJoints, OtherTextsAreRefused) {
  for (const auto& [text, word] : {std::pair{"tail=0,0,0", "leftHand"},
                                   {"leftHand", "x,y,z"},
                                   {"leftHand=1,2", "x,y,z"},
                                   {"leftHand=1,2,3,4", "x,y,z"},
                                   {"leftHand=1,2,nan", "x,y,z"},
                                   {"leftHand=1,two,3", "x,y,z"},
                                   {"head=0,1,0 tail", "'tail'"},
                                   {"hips=0,0,0 hips=1,0,0", "hips is placed twice"},
                                   {"\x1b[1m=0,0,0", "x1b"}}) {
    EXPECT_THAT(ParsePlacedJoints(text).status(), HasStatus(kInvalid, HasSubstr(word))) << text;
  }
}

TEST(PlacedJoints, WhatIsNoJointIsRefused) {
  EXPECT_THAT(CheckPlacedJoints({{kHead, {0, 1, 0}}}), IsOk());
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  EXPECT_THAT(CheckPlacedJoints({{kHead, {0, kInfinity, 0}}}),
              HasStatus(kInvalid, HasSubstr("finite")));
  for (const int joint : {-1, kNumHumanJoints, 1000}) {
    EXPECT_THAT(CheckPlacedJoints({{joint, {0, 0, 0}}}),
                HasStatus(kInvalid, HasSubstr("no joint")));
  }
}

}  // namespace
}  // namespace pleat
