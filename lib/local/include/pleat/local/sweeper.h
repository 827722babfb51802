// Runs retention again and again.
#pragma once

#include <memory>
#include <thread>

#include "pleat/local/retention.h"

namespace pleat {

class StopSignal;

class Sweeper {
 public:
  // Starts a thread of the lowest priority, which runs at once and then every `period_seconds`,
  // above 0. What `target` points to must outlive it.
  Sweeper(RetentionTarget target, RetentionRules rules, double period_seconds);
  // Ends the thread, after the pass that it is in.
  ~Sweeper();
  Sweeper(const Sweeper&) = delete;
  Sweeper& operator=(const Sweeper&) = delete;

 private:
  const std::unique_ptr<StopSignal> stop_;
  std::thread thread_;
};

}  // namespace pleat
