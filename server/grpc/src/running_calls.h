// The calls under way that showed a token, so that those of a revoked token can be ended.
#pragma once

#include <grpcpp/server_context.h>

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>

namespace pleat {

// A call can be cancelled from here while another thread ends it. Each has a lock of its own for
// that, held while it is cancelled: its end waits. The lock is recursive, because TryCancel may run
// the last callbacks of the call, and with them its end, before it returns. Thread-safe.
class RunningCalls {
  struct Call {
    std::recursive_mutex mutex;
    const grpc::ServerContextBase* context = nullptr;  // guarded by mutex; null after the end
  };
  using Calls = std::multimap<std::string, std::shared_ptr<Call>>;  // by token id

 public:
  // Keeps a call in the list as long as it lives, which must be no longer than the call.
  class Entry {
   public:
    Entry(RunningCalls* calls, const std::string& token_id, const grpc::ServerContextBase* context);
    ~Entry();
    Entry(const Entry&) = delete;
    Entry& operator=(const Entry&) = delete;

   private:
    RunningCalls* const calls_;
    Calls::iterator place_;
  };

  // Cancels the calls of all tokens for which `is_good` says no. It asks once for each token.
  void CancelUnless(const std::function<bool(const std::string& token_id)>& is_good);

 private:
  std::mutex mutex_;  // never held while a call is cancelled
  Calls calls_;       // guarded by mutex_
};

}  // namespace pleat
