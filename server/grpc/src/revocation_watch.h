// Ends the calls of tokens that are no longer good.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>

#include "pleat/identity/token_registry.h"
#include "pleat/reactors/running_calls.h"

namespace pleat {

// New calls are checked when they begin (admission.h). This looks once in `period` whether those
// that began before may go on.
class RevocationWatch {
 public:
  // Both must outlive it.
  RevocationWatch(TokenRegistry* tokens, RunningCalls* calls,
                  std::chrono::milliseconds period = std::chrono::milliseconds(500));
  ~RevocationWatch();
  RevocationWatch(const RevocationWatch&) = delete;
  RevocationWatch& operator=(const RevocationWatch&) = delete;

 private:
  void Run();

  TokenRegistry* const tokens_;
  RunningCalls* const calls_;
  const std::chrono::milliseconds period_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool stop_ = false;  // guarded by mutex_
  std::thread thread_;
};

}  // namespace pleat
