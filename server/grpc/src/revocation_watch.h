// Ends the calls of tokens that are no longer good.
#pragma once

#include <chrono>
#include <thread>

#include "pleat/base/stop_signal.h"
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
  StopSignal stop_;
  std::thread thread_;
};

}  // namespace pleat
