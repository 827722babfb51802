// Ends a thread that pauses.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>

namespace pleat {

// Thread-safe.
class StopSignal {
 public:
  void Set() {
    {
      std::lock_guard lock(mutex_);
      stopped_ = true;
    }
    changed_.notify_all();
  }
  // Waits for so many seconds; false when it was set, then or before.
  bool Pause(double seconds) {
    std::unique_lock lock(mutex_);
    return !changed_.wait_for(lock, std::chrono::duration<double>(seconds),
                              [this] { return stopped_; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool stopped_ = false;  // guarded by mutex_
};

}  // namespace pleat
