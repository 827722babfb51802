// Ends a thread that does something again and again.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>

namespace pleat {

// Thread-safe. The thread runs `while (stop.Pause(period)) Work();`, and whoever ends it calls Set
// and joins it.
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
  bool Pause(double seconds) { return Pause(std::chrono::duration<double>(seconds)); }
  bool Pause(std::chrono::duration<double> time) {
    std::unique_lock lock(mutex_);
    return !changed_.wait_for(lock, time, [this] { return stopped_; });
  }
  bool is_set() {
    std::lock_guard lock(mutex_);
    return stopped_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool stopped_ = false;  // guarded by mutex_
};

}  // namespace pleat
