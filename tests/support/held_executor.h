// An executor whose tasks wait until a test lets them go.
#pragma once

#include <latch>
#include <utility>

#include "pleat/base/executor.h"

namespace pleat {

class HeldExecutor {
 public:
  HeldExecutor() {
    executor_.Post([this] { released_.wait(); });
  }
  ~HeldExecutor() { Release(); }

  Executor* get() { return &executor_; }
  // From now on tasks run, one at a time, in the order in which they were posted.
  void Release() {
    if (!std::exchange(is_released_, true)) released_.count_down();
  }
  // Waits until every task that has been posted so far has run, and has been destroyed.
  void RunAll() {
    Release();
    std::latch done(1);
    executor_.Post([&done] { done.count_down(); });
    done.wait();
  }

 private:
  bool is_released_ = false;
  std::latch released_{1};
  Executor executor_{1};
};

}  // namespace pleat
