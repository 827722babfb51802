#include "cli/io/placed_joints.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cli/exit_code.h"
#include "pleat/skeleton/human_template.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

TEST(PlacedJoints, AreReadByNameAndPosition) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::vector<PlacedJoint> placed,
                             ParsePlacedJoints({"leftHand=.5,-1e-1,2", "hips=0,1,0"}));
  ASSERT_EQ(placed.size(), 2u);
  EXPECT_EQ(placed[0].joint, kLeftHand);
  EXPECT_EQ(placed[0].position, Eigen::Vector3d(.5, -.1, 2));
  EXPECT_EQ(placed[1].joint, kHips);
}

TEST(PlacedJoints, OtherTextsAreUsageErrors) {
  for (const auto& [text, word] : {std::pair{"tail=0,0,0", "leftHand"},
                                   {"leftHand", "x,y,z"},
                                   {"leftHand=1,2", "x,y,z"},
                                   {"leftHand=1,2,3,4", "x,y,z"},
                                   {"leftHand=1,2,nan", "x,y,z"},
                                   {"leftHand=1,two,3", "x,y,z"}}) {
    const absl::Status status = ParsePlacedJoints({text}).status();
    EXPECT_TRUE(IsUsageError(status)) << text;
    EXPECT_THAT(status.message(), HasSubstr(word)) << text;
  }
  EXPECT_THAT(ParsePlacedJoints({"hips=0,0,0", "hips=1,0,0"}).status().message(),
              HasSubstr("twice"));
}

}  // namespace
}  // namespace pleat
