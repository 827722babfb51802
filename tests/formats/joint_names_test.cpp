#include "pleat/formats/joint_names.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace pleat {
namespace {

struct NamedJoint {
  std::string name;
  bool is_end = false;
};

TEST(JointNamesTest, TipsAreLeftOutAndLongListsCut) {
  const std::vector<NamedJoint> joints = {{"hips"}, {"a\nb"}, {"tip", true}, {"head"}};
  EXPECT_EQ(ListJointNames(joints, 3), "hips, a\\x0ab, head");
  EXPECT_EQ(ListJointNames(joints, 2), "hips, a\\x0ab, ...");
  EXPECT_EQ(ListJointNames(std::vector<NamedJoint>(), 2), "");
}

}  // namespace
}  // namespace pleat
