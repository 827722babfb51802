#include "pleat/base/wall_clock.h"

#include <gtest/gtest.h>

#include <ctime>

namespace pleat {
namespace {

TEST(WallClock, TheTimeOfThisMachineIsItsDefault) {
  const WallClock clock = SystemTime;
  const std::time_t before = std::time(nullptr);
  const std::time_t now = absl::ToTimeT(clock());
  EXPECT_GE(now, before);
  EXPECT_LE(now, std::time(nullptr));
}

}  // namespace
}  // namespace pleat
