#include "pleat/local/sweeper.h"

#include <utility>

#include "pleat/base/stop_signal.h"
#include "pleat/base/thread_priority.h"

namespace pleat {

Sweeper::Sweeper(RetentionTarget target, RetentionRules rules, double period_seconds)
    : stop_(std::make_unique<StopSignal>()),
      thread_([stop = stop_.get(), target = std::move(target), rules, period_seconds] {
        RunInIdleTime();
        do {
          RunRetention(target, rules);
        } while (stop->Pause(period_seconds));
      }) {}

Sweeper::~Sweeper() {
  stop_->Set();
  thread_.join();
}

}  // namespace pleat
