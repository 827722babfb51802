#include "pleat/base/progress.h"

#include <vector>

#include "support/status_matchers.h"

namespace pleat {
namespace {

TEST(ProgressTest, DefaultReportsToNobodyAndIsNeverCancelled) {
  const Progress progress;
  EXPECT_THAT(progress.Report(0.5), IsOk());
  EXPECT_FALSE(progress.cancelled());
}

TEST(ProgressTest, NestedStagesMapToTheWhole) {
  std::vector<ProgressUpdate> updates;
  const Progress whole([&](const ProgressUpdate& update) { updates.push_back(update); }, nullptr);
  const Progress half = whole.Stage("fit", 0.5, 1);
  const Progress quarter = half.Stage("walk", 0, 0.5);
  EXPECT_THAT(half.Report(0.5, 3.25), IsOk());
  EXPECT_THAT(quarter.Report(0.5), IsOk());
  EXPECT_THAT(quarter.Report(7), IsOk());  // clamped
  ASSERT_EQ(updates.size(), 3u);
  EXPECT_EQ(updates[0].stage, "fit");
  EXPECT_DOUBLE_EQ(updates[0].fraction, 0.75);
  EXPECT_EQ(updates[0].objective, 3.25);
  EXPECT_EQ(updates[1].stage, "walk");
  EXPECT_DOUBLE_EQ(updates[1].fraction, 0.625);
  EXPECT_FALSE(updates[1].objective.has_value());
  EXPECT_DOUBLE_EQ(updates[2].fraction, 0.75);
}

TEST(ProgressTest, WhatIsRepeatedInAnotherWayNeverGoesBack) {
  std::vector<ProgressUpdate> updates;
  const Progress whole([&](const ProgressUpdate& update) { updates.push_back(update); }, nullptr);
  const Progress forward = whole.Stage("compress", 0, .5).ForwardOnly();
  EXPECT_THAT(forward.Stage("encode", 0, 1).Report(.6), IsOk());
  EXPECT_THAT(forward.Stage("align", .1, 1).Report(.1), IsOk());
  EXPECT_THAT(forward.Stage("encode", .1, 1).Report(.9), IsOk());
  ASSERT_EQ(updates.size(), 3u);
  EXPECT_NEAR(updates[0].fraction, .3, 1e-12);
  EXPECT_NEAR(updates[1].fraction, .3, 1e-12);
  EXPECT_EQ(updates[1].stage, "align");
  EXPECT_NEAR(updates[2].fraction, .455, 1e-12);
}

TEST(ProgressTest, CancellationReachesSubStages) {
  bool cancel = false;
  const Progress stage = Progress(nullptr, [&] { return cancel; }).Stage("learn", 0, 1);
  EXPECT_THAT(stage.Report(0), IsOk());
  cancel = true;
  EXPECT_TRUE(stage.cancelled());
  EXPECT_THAT(stage.Report(0.1), HasStatus(absl::StatusCode::kCancelled, testing::_));
}

}  // namespace
}  // namespace pleat
