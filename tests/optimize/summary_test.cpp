#include "pleat/optimize/summary.h"

#include <gtest/gtest.h>

#include <set>

namespace pleat {
namespace {

TEST(SummaryTest, EveryReasonHasANameOfItsOwn) {
  std::set<std::string> names;
  for (const StopReason reason : {StopReason::kMaxIterations, StopReason::kGradientTolerance,
                                  StopReason::kObjectiveTolerance, StopReason::kNoProgress}) {
    const std::string name = StopReasonName(reason);
    EXPECT_NE(name, "unknown");
    EXPECT_TRUE(names.insert(name).second) << name;
  }
  EXPECT_EQ(StopReasonName(StopReason::kGradientTolerance), "gradient tolerance");
}

TEST(SummaryTest, ANumberThatIsNoReasonIsToldApart) {
  EXPECT_EQ(StopReasonName(static_cast<StopReason>(99)), "unknown");
}

}  // namespace
}  // namespace pleat
