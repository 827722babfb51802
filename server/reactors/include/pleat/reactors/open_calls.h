// How many calls are open, for a server that waits until they have ended.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>

namespace pleat {

// Thread-safe.
class OpenCalls {
 public:
  OpenCalls() = default;
  OpenCalls(const OpenCalls&) = delete;
  OpenCalls& operator=(const OpenCalls&) = delete;

  // Waits until no call is open, at most until `deadline`. False when the deadline came first.
  bool WaitUntilNone(std::chrono::steady_clock::time_point deadline);
  void WaitUntilNone();  // without a deadline

  // Counts one call as long as it lives.
  class Entry {
   public:
    explicit Entry(OpenCalls* calls);
    // After the last one a waiting thread may destroy the OpenCalls.
    ~Entry();
    Entry(const Entry&) = delete;
    Entry& operator=(const Entry&) = delete;

   private:
    OpenCalls* calls_;
  };

 private:
  std::mutex mutex_;
  std::condition_variable none_;  // signaled when count_ falls to 0
  int count_ = 0;                 // guarded by mutex_
};

}  // namespace pleat
