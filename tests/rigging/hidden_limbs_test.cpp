// Limbs that the surface hides: robes to the floor, arms that lie against the body. The skeleton is
// right, or what may be wrong about it is said, or the body is refused with what to do.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <ostream>
#include <string>

#include "pleat/rigging/auto_rig.h"
#include "rigging/test_bodies.h"
#include "support/capsule_figure.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::AnyOf;
using ::testing::Contains;
using ::testing::HasSubstr;

struct HiddenLimbs {
  std::string name;
  CapsuleFigureOptions figure;
};

void PrintTo(const HiddenLimbs& body, std::ostream* out) { *out << body.name; }

// Errors of joints as shares of the height.
Eigen::RowVectorXd ErrorsOf(const Rig& rig, const CapsuleFigure& figure) {
  const Eigen::RowVectorXd y = figure.mesh.positions.row(1);
  return (rig.skeleton.RestPositions() - figure.joints).colwise().norm() /
         (y.maxCoeff() - y.minCoeff());
}

class HiddenLimbsTest : public ::testing::TestWithParam<HiddenLimbs> {};

TEST_P(HiddenLimbsTest, NothingIsWrongInSilence) {
  const CapsuleFigure figure = MakeCapsuleFigure(GetParam().figure);
  AutoRigSummary summary;
  const absl::StatusOr<Rig> rig = AutoRig(MakeStillSequence(figure.mesh), {}, &summary);
  if (!rig.ok()) {
    EXPECT_THAT(rig, HasStatus(absl::StatusCode::kFailedPrecondition, HasSubstr("--at")));
    return;
  }
  const Eigen::RowVectorXd errors = ErrorsOf(*rig, figure);
  if (errors.mean() < .04 && errors.maxCoeff() < .1) return;
  EXPECT_THAT(summary.warnings, Contains(AnyOf(HasSubstr("--at"), HasSubstr("set the yaw"))))
      << errors;
}

INSTANTIATE_TEST_SUITE_P(
    Arms, HiddenLimbsTest,
    ::testing::Values(
        HiddenLimbs{"Crossed", {.arms = ArmPose::kCrossed, .cell_m = .03}},
        HiddenLimbs{"CrossedInSleeves",
                    {.yaw_degrees = 90, .arms = ArmPose::kCrossed, .sleeve = .05, .cell_m = .03}},
        HiddenLimbs{"Folded", {.arms = ArmPose::kFolded, .cell_m = .03}},
        HiddenLimbs{"FoldedOnShortLegs",
                    {.arms = ArmPose::kFolded, .leg_length = .5, .cell_m = .03}},
        HiddenLimbs{"Praying", {.arms = ArmPose::kPraying, .cell_m = .03}},
        HiddenLimbs{"OnHips", {.arms = ArmPose::kOnHips, .cell_m = .03}},
        HiddenLimbs{"BehindTheBack", {.arms = ArmPose::kBehindBack, .cell_m = .03}}),
    [](const auto& instance) { return instance.param.name; });

INSTANTIATE_TEST_SUITE_P(
    Robes, HiddenLimbsTest,
    ::testing::Values(
        HiddenLimbs{"Narrow", {.robe_hem = .12, .cell_m = .03}},
        HiddenLimbs{"FromBehind", {.yaw_degrees = 180, .robe_hem = .16, .cell_m = .03}},
        HiddenLimbs{"Wide", {.yaw_degrees = 30, .robe_hem = .22, .cell_m = .03}},
        HiddenLimbs{"Bell", {.robe_hem = .16, .robe_is_hollow = true, .cell_m = .022}},
        HiddenLimbs{"ArmsCrossed",
                    {.arms = ArmPose::kCrossed, .robe_hem = .16, .sleeve = .05, .cell_m = .03}}),
    [](const auto& instance) { return instance.param.name; });

// Under a robe the legs are straight and have the proportions of the template, whoever faces where.
TEST(HiddenLimbs, LegsUnderARobeStandOnTheFloor) {
  const CapsuleFigure figure = MakeCapsuleFigure({.robe_hem = .16, .cell_m = .03});
  AutoRigSummary summary;
  AutoRigOptions options;
  options.yaw_degrees = 0;
  PLEAT_ASSERT_OK_AND_ASSIGN(const Rig rig,
                             AutoRig(MakeStillSequence(figure.mesh), options, &summary));
  EXPECT_LT(ErrorsOf(rig, figure).maxCoeff(), .08) << ErrorsOf(rig, figure);
  EXPECT_THAT(summary.warnings, Contains(HasSubstr("hide the legs")));
  EXPECT_GE(summary.residual, .03);  // never trusted
}

}  // namespace
}  // namespace pleat
