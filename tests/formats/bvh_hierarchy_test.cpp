#include "bvh_hierarchy.h"

#include "absl/strings/str_replace.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr char kTwoJoints[] = R"(HIERARCHY
ROOT hips bone
{
  OFFSET 0 1 -2.5
  CHANNELS 4 Yrotation Xposition zrotation ZPOSITION
  JOINT knee {
    OFFSET 0 -1 0
    CHANNELS 1 Xrotation
    End Site
    {
      OFFSET 0 -.5 0
    }
  }
}
MOTION
Frames: 1
)";

absl::StatusOr<BvhHierarchy> ReadHierarchy(const std::string& text) {
  TextWords words(text);
  return ReadBvhHierarchy(&words);
}

absl::StatusOr<BvhHierarchy> WithReplaced(const char* before, const char* after) {
  return ReadHierarchy(absl::StrReplaceAll(kTwoJoints, {{before, after}}));
}

TEST(BvhHierarchyTest, JointsHaveAnyChannelsInAnyOrder) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const BvhHierarchy hierarchy, ReadHierarchy(kTwoJoints));
  ASSERT_EQ(hierarchy.joints.size(), 3u);
  EXPECT_EQ(hierarchy.joints[0].name, "hips bone");
  EXPECT_EQ(hierarchy.joints[0].parent, -1);
  EXPECT_EQ(hierarchy.joints[0].offset, Eigen::Vector3d(0, 1, -2.5));
  EXPECT_EQ(hierarchy.joints[1].name, "knee");
  EXPECT_EQ(hierarchy.joints[2].parent, 1);
  EXPECT_TRUE(hierarchy.joints[2].is_end);
  ASSERT_EQ(hierarchy.channels.size(), 5u);
  EXPECT_TRUE(hierarchy.channels[0].is_rotation);
  EXPECT_EQ(hierarchy.channels[0].axis, 1);
  EXPECT_FALSE(hierarchy.channels[3].is_rotation);
  EXPECT_EQ(hierarchy.channels[3].axis, 2);
  EXPECT_EQ(hierarchy.channels[4].joint, 1);
}

TEST(BvhHierarchyTest, WhatIsWrongIsNamedWithItsLine) {
  EXPECT_THAT(WithReplaced("HIERARCHY", "HIERARCHIES"),
              HasStatus(kInvalid, AllOf(HasSubstr("line 1"), HasSubstr("'HIERARCHIES'"))));
  EXPECT_THAT(WithReplaced("0 1 -2.5", "0 1 x"),
              HasStatus(kInvalid, AllOf(HasSubstr("line 4"), HasSubstr("'x'"))));
  EXPECT_THAT(WithReplaced("CHANNELS 1 Xrotation", "CHANNELS 1 Xscale"),
              HasStatus(kInvalid, AllOf(HasSubstr("line 8"), HasSubstr("'Xscale'"))));
  EXPECT_THAT(WithReplaced("CHANNELS 1 Xrotation", "CHANNELS 2 Xrotation Xrotation"),
              HasStatus(kInvalid, HasSubstr("twice")));
  EXPECT_THAT(WithReplaced("CHANNELS 1", "CHANNELS 1.5"), HasStatus(kInvalid, HasSubstr("'1.5'")));
  EXPECT_THAT(WithReplaced("CHANNELS 1", "CHANNELS -1"), HasStatus(kInvalid, HasSubstr("'-1'")));
  EXPECT_THAT(WithReplaced("JOINT", "ROOT"), HasStatus(kInvalid, HasSubstr("inside")));
  EXPECT_THAT(WithReplaced("ROOT", "JOINT"), HasStatus(kInvalid, HasSubstr("outside")));
  EXPECT_THAT(WithReplaced("Site", "Sight"), HasStatus(kInvalid, HasSubstr("'Sight'")));
  EXPECT_THAT(WithReplaced("MOTION", ""), HasStatus(kInvalid, HasSubstr("'Frames:'")));
  EXPECT_THAT(WithReplaced("    End Site\n    {", "    End Site\n    { CHANNELS 1 Xrotation"),
              HasStatus(kInvalid, HasSubstr("End Site has channels")));
  EXPECT_THAT(WithReplaced("}\nMOTION", "MOTION"), HasStatus(kInvalid, HasSubstr("not closed")));
  EXPECT_THAT(ReadHierarchy("HIERARCHY MOTION"), HasStatus(kInvalid, HasSubstr("no ROOT")));
  EXPECT_THAT(ReadHierarchy("HIERARCHY ROOT a\n{ OFFSET 0 0 0 }\nMOTION"),
              HasStatus(kInvalid, HasSubstr("CHANNELS")));
}

TEST(BvhHierarchyTest, SeveralRootsAreRead) {
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const BvhHierarchy hierarchy,
      ReadHierarchy("HIERARCHY\nROOT a\n{ CHANNELS 1 Xrotation }\nROOT b\n{ }\nMOTION"));
  EXPECT_EQ(hierarchy.joints[1].parent, -1);
}

TEST(BvhHierarchyTest, DepthAndCountAreBounded) {
  std::string deep = "HIERARCHY\nROOT r\n{\n";
  for (int j = 0; j < kMaxClipJoints; ++j) deep += "JOINT j\n{\n";
  EXPECT_THAT(ReadHierarchy(deep),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("4096")));
}

}  // namespace
}  // namespace pleat
