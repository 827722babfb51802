#include "pleat/base/stop_signal.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>

namespace pleat {
namespace {

TEST(StopSignalTest, APauseEndsWithItsTimeOrWithTheSignal) {
  StopSignal stop;
  EXPECT_TRUE(stop.Pause(1e-4));
  EXPECT_TRUE(stop.Pause(std::chrono::microseconds(1)));
  EXPECT_FALSE(stop.is_set());
  stop.Set();
  EXPECT_TRUE(stop.is_set());
  EXPECT_FALSE(stop.Pause(1e9));
  EXPECT_FALSE(stop.Pause(0));
}

TEST(StopSignalTest, AThreadThatPausesForLongEndsAtOnce) {
  StopSignal stop;
  std::atomic<int> num_rounds = 0;
  std::thread thread([&] {
    while (stop.Pause(1e9)) ++num_rounds;
  });
  stop.Set();
  thread.join();
  EXPECT_EQ(num_rounds, 0);
}

}  // namespace
}  // namespace pleat
