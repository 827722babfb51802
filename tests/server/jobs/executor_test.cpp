#include "pleat/jobs/executor.h"

#include <gtest/gtest.h>

#include <atomic>
#include <memory>

namespace pleat {
namespace {

TEST(ExecutorTest, RunsEverythingBeforeItEnds) {
  std::atomic<int> count = 0;
  {
    Executor executor(3);
    EXPECT_EQ(executor.num_threads(), 3);
    for (int i = 0; i < 1000; ++i) executor.Post([&] { ++count; });
  }
  EXPECT_EQ(count, 1000);
}

TEST(ExecutorTest, OneThreadKeepsTheOrder) {
  std::vector<int> order;
  {
    Executor executor(1);
    for (int i = 0; i < 100; ++i) executor.Post([&order, i] { order.push_back(i); });
  }
  for (int i = 0; i < 100; ++i) EXPECT_EQ(order[i], i);
}

TEST(ExecutorTest, TasksMayPostTasks) {
  std::atomic<int> count = 0;
  {
    Executor executor(2);
    executor.Post([&] {
      ++count;
      executor.Post([&] { ++count; });
    });
  }
  EXPECT_EQ(count, 2);
}

}  // namespace
}  // namespace pleat
