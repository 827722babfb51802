#include "trial_progress.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "support/status_matchers.h"

namespace pleat {
namespace {

class TrialProgressTest : public testing::Test {
 protected:
  const Progress progress_{[this](const ProgressUpdate& update) { updates_.push_back(update); },
                           [this] { return cancelled_; }};
  bool cancelled_ = false;
  std::vector<ProgressUpdate> updates_;
};

TEST_F(TrialProgressTest, TrialsThatAreForeseenHaveEqualShares) {
  TrialProgress trials(progress_);
  for (int trial = 0; trial < 4; ++trial) {
    EXPECT_THAT(trials.Next("encode", 5 - trial).Report(1), IsOk());
    EXPECT_EQ(updates_.back().stage, "encode");
    EXPECT_NEAR(updates_.back().fraction, .2 * (trial + 1), 1e-12);
  }
}

TEST_F(TrialProgressTest, MoreTrialsThanForeseenNeitherGoBackNorStandAtTheEnd) {
  TrialProgress trials(progress_);
  for (int trial = 0; trial < 12; ++trial) {
    const Progress part = trials.Next("encode", 3 - trial);
    EXPECT_THAT(part.Report(0), IsOk());
    EXPECT_THAT(part.Report(1), IsOk());
  }
  for (size_t i = 1; i < updates_.size(); ++i) {
    EXPECT_GE(updates_[i].fraction, updates_[i - 1].fraction) << i;
    EXPECT_LT(updates_[i].fraction, 1) << i;
  }
}

TEST_F(TrialProgressTest, PartsKeepTheStageAndPassCancellationOn) {
  const Progress stage = progress_.Stage("check", .5, 1);
  const Progress part = PartOf(stage, .2, .4);
  EXPECT_THAT(part.Report(.5, 7.0), IsOk());
  EXPECT_EQ(updates_[0].stage, "check");
  EXPECT_NEAR(updates_[0].fraction, .65, 1e-12);
  EXPECT_EQ(updates_[0].objective, 7.0);
  cancelled_ = true;
  EXPECT_THAT(part.Report(1), HasStatus(absl::StatusCode::kCancelled, testing::_));
  EXPECT_EQ(updates_.size(), 1u);
}

}  // namespace
}  // namespace pleat
