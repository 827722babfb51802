#include "pleat/cache/charge_account.h"

#include <gtest/gtest.h>

#include <limits>

#include "support/status_matchers.h"

namespace pleat {
namespace {

TEST(ChargeAccountTest, NeverExceedsItsCapacity) {
  ChargeAccount account(100);
  EXPECT_THAT(account.Charge(60, "a"), IsOk());
  EXPECT_FALSE(account.Fits(41));
  EXPECT_THAT(account.Charge(41, "b"),
              HasStatus(absl::StatusCode::kResourceExhausted, testing::HasSubstr("'b'")));
  EXPECT_THAT(account.Charge(std::numeric_limits<uint64_t>::max(), "c"),
              HasStatus(absl::StatusCode::kResourceExhausted, testing::_));
  EXPECT_THAT(account.Charge(40, "d"), IsOk());
  account.Release(60);
  EXPECT_EQ(account.used_bytes(), 40u);
}

}  // namespace
}  // namespace pleat
