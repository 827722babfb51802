#include "pleat/reactors/open_calls.h"

namespace pleat {

bool OpenCalls::WaitUntilNone(std::chrono::steady_clock::time_point deadline) {
  std::unique_lock lock(mutex_);
  return none_.wait_until(lock, deadline, [this] { return count_ == 0; });
}

void OpenCalls::WaitUntilNone() {
  std::unique_lock lock(mutex_);
  none_.wait(lock, [this] { return count_ == 0; });
}

OpenCalls::Entry::Entry(OpenCalls* calls) : calls_(calls) {
  std::lock_guard lock(calls_->mutex_);
  ++calls_->count_;
}

OpenCalls::Entry::~Entry() {
  // The signal is given with the lock held: without it the thread that waits could see the count,
  // destroy the condition variable and leave this thread with a dead one.
  std::lock_guard lock(calls_->mutex_);
  if (--calls_->count_ == 0) calls_->none_.notify_all();
}

}  // namespace pleat
