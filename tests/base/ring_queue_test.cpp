#include "pleat/base/ring_queue.h"

#include <gtest/gtest.h>

#include <string>

namespace pleat {
namespace {

TEST(RingQueueTest, KeepsTheOrderWhileItGrowsAroundItsEnd) {
  RingQueue<int> queue;
  int pushed = 0, popped = 0;
  for (int round = 0; round < 40; ++round) {
    for (int i = 0; i < 3; ++i) queue.PushBack() = pushed++;
    EXPECT_EQ(queue.back(), pushed - 1);
    for (int i = 0; i < 2; ++i) {
      ASSERT_EQ(queue.front(), popped++);
      queue.PopFront();
    }
    EXPECT_EQ(queue.size(), static_cast<size_t>(round + 1));
  }
  while (!queue.empty()) {
    ASSERT_EQ(queue.front(), popped++);
    queue.PopFront();
  }
  EXPECT_EQ(popped, pushed);
}

TEST(RingQueueTest, AnElementFindsTheMemoryOfAnEarlierOne) {
  RingQueue<std::string> queue(std::vector<std::string>(2));
  const std::string text(100, 'x');
  for (int i = 0; i < 2; ++i) {
    queue.PushBack() = text;
    queue.PopFront();
  }
  std::string& again = queue.PushBack();
  const char* memory = again.data();
  again.assign(text);
  EXPECT_EQ(again.data(), memory);
}

}  // namespace
}  // namespace pleat
