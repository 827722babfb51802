#include "cli/show/rig_sheet.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pleat/skeleton/human_template.h"
#include "support/capsule_figure.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::ElementsAre;
using ::testing::StartsWith;

TEST(RigSheet, ReadsTheSideFromTheName) {
  const std::vector<std::string> names = {"hips",  "leftFoot", "RightArm", "hand.L",
                                          "toe_r", "L_knee",   "pelvis",   "tail"};
  std::vector<Joint> joints;
  for (const std::string& name : names) {
    joints.push_back({name, static_cast<int>(joints.size()) - 1, Eigen::Vector3d::Zero()});
  }
  EXPECT_THAT(SidesOfJoints(*Skeleton::Create(joints)),
              ElementsAre(BodySide::kMiddle, BodySide::kLeft, BodySide::kRight, BodySide::kLeft,
                          BodySide::kRight, BodySide::kLeft, BodySide::kMiddle, BodySide::kMiddle));
}

TEST(RigSheet, ShowsEveryCharacterFromTwoSides) {
  const CapsuleFigure figure = MakeCapsuleFigure({.yaw_degrees = 90, .cell_m = .06});
  RigSheetRow row{"figure", MakeTopology(figure.mesh), HumanTemplate(), 90, {}};
  row.views.push_back({"rest", figure.mesh.positions, figure.joints});
  RigSheetRow large = row;  // another unit, one view more
  large.views[0].positions *= 100;
  large.views[0].joints *= 100;
  large.views.push_back(large.views[0]);
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::string png,
                             RenderRigSheet({row, large}, {.tile_width = 60, .tile_height = 80}));
  EXPECT_THAT(png, StartsWith("\x89PNG"));
  const auto side = [&png](size_t at) {  // width and height, big endian
    return static_cast<unsigned char>(png[at + 2]) * 256 + static_cast<unsigned char>(png[at + 3]);
  };
  EXPECT_GT(side(16), 4 * 60);
  EXPECT_GT(side(20), 2 * 80);
}

TEST(RigSheet, NeedsSomethingToShow) { EXPECT_FALSE(RenderRigSheet({}, {}).ok()); }

}  // namespace
}  // namespace pleat
