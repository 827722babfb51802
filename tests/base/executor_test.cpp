#include "pleat/base/executor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <future>
#include <latch>
#include <memory>
#include <string>
#include <thread>
#include <vector>

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

// A flow with many tasks delays the others by one task per round.
TEST(ExecutorTest, FlowsTakeTurns) {
  std::vector<int> order;
  {
    Executor executor(1);
    std::promise<void> everything_is_posted;
    executor.Post([posted = everything_is_posted.get_future().share()] { posted.wait(); });
    for (int i = 0; i < 100; ++i) executor.Post([&order, i] { order.push_back(i); }, 7);
    for (int i = 0; i < 3; ++i) executor.Post([&order, i] { order.push_back(1000 + i); }, 8);
    executor.Post([&order] { order.push_back(2000); });  // a flow of its own
    everything_is_posted.set_value();
  }
  ASSERT_EQ(order.size(), 104u);
  EXPECT_EQ(std::vector<int>(order.begin(), order.begin() + 8),
            (std::vector<int>{0, 1000, 2000, 1, 1001, 2, 1002, 3}));
  EXPECT_TRUE(std::is_sorted(order.begin() + 7, order.end()));
}

TEST(ExecutorTest, FlowsOnManyThreadsRunEverythingOnce) {
  std::atomic<int> count = 0;
  {
    Executor executor(4);
    std::vector<std::thread> posters;
    for (int p = 0; p < 4; ++p) {
      posters.emplace_back([&, p] {
        for (int i = 0; i < 2000; ++i) executor.Post([&] { ++count; }, 1 + (p + i) % 3);
      });
    }
    for (std::thread& poster : posters) poster.join();
  }
  EXPECT_EQ(count, 8000);
}

TEST(ExecutorTest, KindsShareTheThreadsFourToOne) {
  std::string order;
  {
    Executor executor(1);
    std::latch begun(1), start(1);
    executor.Post([&] {
      begun.count_down();
      start.wait();
    });
    begun.wait();  // the first turn is not one of those that are counted
    for (int i = 0; i < 5; ++i) {
      executor.Post([&] { order += 'b'; }, 0, TurnKind::kBulk);
    }
    for (int i = 0; i < 10; ++i) executor.Post([&] { order += 'i'; });
    start.count_down();
  }
  EXPECT_EQ(order, "iiiibiiiibiibbb");
}

TEST(ExecutorTest, FlowsTakeTurnsWithinTheirKind) {
  std::string order;
  {
    Executor executor(1);
    std::latch start(1);
    executor.Post([&] { start.wait(); });
    for (int i = 0; i < 3; ++i) {
      executor.Post([&] { order += 'a'; }, 7, TurnKind::kBulk);
    }
    executor.Post([&] { order += 'b'; }, 8, TurnKind::kBulk);
    start.count_down();
  }
  EXPECT_EQ(order, "abaa");
}

}  // namespace
}  // namespace pleat
