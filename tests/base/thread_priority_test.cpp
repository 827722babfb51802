#include "pleat/base/thread_priority.h"

#include <gtest/gtest.h>
#include <pthread.h>
#include <sched.h>

#include <thread>

namespace pleat {
namespace {

int PolicyOfThisThread() {
  int policy = 0;
  sched_param parameters{};
  EXPECT_EQ(pthread_getschedparam(pthread_self(), &policy, &parameters), 0);
  return policy;
}

TEST(ThreadPriorityTest, AnIdleThreadStartsIdleThreadsAndChangesNoOther) {
  int own = -1, child = -1;
  std::thread idle([&] {
    RunInIdleTime();
    own = PolicyOfThisThread();
    std::thread([&] { child = PolicyOfThisThread(); }).join();
  });
  idle.join();
  EXPECT_EQ(own, SCHED_IDLE);
  EXPECT_EQ(child, SCHED_IDLE);
  EXPECT_EQ(PolicyOfThisThread(), SCHED_OTHER);
}

}  // namespace
}  // namespace pleat
