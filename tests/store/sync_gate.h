// Holds up syncs, so that a test proves what goes on while one of them waits for the disk.
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "pleat/store/sync_hook.h"

namespace pleat {

// Records the path of every sync. While it is closed, syncs of paths that contain a given text
// wait.
class SyncGate {
 public:
  ~SyncGate() { Open(); }

  SyncHook hook() {
    return [this](const std::string& path) {
      std::unique_lock lock(mutex_);
      paths_.push_back(path);
      if (!Holds(path)) return;
      ++num_waiting_;
      changed_.notify_all();
      changed_.wait(lock, [&] { return !Holds(path); });
      --num_waiting_;
    };
  }

  void Close(std::function<bool(const std::string& path)> holds) {
    std::lock_guard lock(mutex_);
    holds_ = std::move(holds);
  }
  void Open() {
    std::lock_guard lock(mutex_);
    holds_ = nullptr;
    changed_.notify_all();
  }
  void WaitForOneThatWaits() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return num_waiting_ > 0; });
  }
  // The paths since the last call.
  std::vector<std::string> TakePaths() {
    std::lock_guard lock(mutex_);
    return std::exchange(paths_, {});
  }

 private:
  bool Holds(const std::string& path) const { return holds_ && holds_(path); }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::function<bool(const std::string&)> holds_;  // empty: open
  int num_waiting_ = 0;
  std::vector<std::string> paths_;
};

// Predicates for SyncGate::Close.
inline auto PathContains(std::string part) {
  return [part = std::move(part)](const std::string& path) {
    return path.find(part) != std::string::npos;
  };
}
inline auto PathEndsWith(std::string end) {
  return [end = std::move(end)](const std::string& path) { return path.ends_with(end); };
}

}  // namespace pleat
