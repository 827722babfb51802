#include "pleat/cache/charge_account.h"

#include <gtest/gtest.h>

#include <limits>

#include "support/status_matchers.h"

namespace pleat {
namespace {

TEST(ChargeAccountTest, NeverExceedsItsCapacity) {
  ChargeAccount account(100);
  {
    PLEAT_ASSERT_OK_AND_ASSIGN(const Reservation sixty, account.Charge(60, "a"));
    EXPECT_FALSE(account.Fits(41));
    EXPECT_THAT(account.Charge(41, "b"),
                HasStatus(absl::StatusCode::kResourceExhausted, testing::HasSubstr("'b'")));
    EXPECT_THAT(account.Charge(std::numeric_limits<uint64_t>::max(), "c"),
                HasStatus(absl::StatusCode::kResourceExhausted, testing::_));
    EXPECT_THAT(account.Charge(40, "d"), IsOk());
  }
  EXPECT_EQ(account.used_bytes(), 0u);
}

TEST(ChargeAccountTest, SharesItsMemoryWithOthers) {
  MemoryBudget all(100, "--memory-bytes");
  ChargeAccount account(80, &all);
  PLEAT_ASSERT_OK_AND_ASSIGN(const Reservation other, all.Reserve(50, "a job"));
  EXPECT_TRUE(account.Fits(50));
  EXPECT_FALSE(account.Fits(51));
  EXPECT_THAT(account.Charge(51, "a"), HasStatus(absl::StatusCode::kResourceExhausted,
                                                 testing::HasSubstr("--memory-bytes")));
  EXPECT_EQ(account.used_bytes(), 0u);
}

}  // namespace
}  // namespace pleat
