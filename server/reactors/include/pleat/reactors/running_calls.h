// The calls under way: how many streams a client has, and whose token a call showed.
#pragma once

#include <grpcpp/server_context.h>

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>

namespace pleat {

// Who makes a call.
struct CallOrigin {
  // Stands for the token that the call shows, or for the address that it comes from. Whoever does
  // not know a token cannot make calls in its name, not even refused ones.
  std::string client;
  std::string token_id;  // as the call says; empty: it shows none
};
// Metadata in which a call of this process says for whom it is made (call_gateway.h). It is
// believed only beside kInsideKey with the secret of this process: the peer of a call inside the
// process is "unknown" to gRPC, and others may come to be so too.
inline constexpr char kInsideKey[] = "x-pleat-inside";
const std::string& InsideSecret();  // random, the same until the process ends
inline constexpr char kForeignPeerKey[] = "x-pleat-peer";
// The same for the ids, separated by commas, of the content that such a call sees without a token.
inline constexpr char kSharedContentKey[] = "x-pleat-shared";
// Empty: nothing is shared with callers without a token.
std::string SharedContentOf(const grpc::ServerContextBase& call);
// The address that a call comes from. A call of this process says for whom it is made, and is
// believed; what others say with the same key is not looked at.
std::string PeerOf(const grpc::ServerContextBase& call);
CallOrigin OriginOf(const grpc::ServerContextBase& call);

// A call can be cancelled from here while another thread ends it. Each has a lock of its own for
// that, held while it is cancelled: its end waits. The lock is recursive, because TryCancel may run
// the last callbacks of the call, and with them its end, before it returns. Thread-safe.
class RunningCalls {
  struct Call {
    std::recursive_mutex mutex;
    const grpc::ServerContextBase* context = nullptr;  // guarded by mutex; null after the end
    std::string request_id{};                          // never changes
    std::string project{};                             // guarded by mutex_ of the list
  };
  using Calls = std::multimap<std::string, std::shared_ptr<Call>>;  // by token id

 public:
  // Keeps a call in the list as long as it lives, which must be no longer than the call.
  class Entry {
   public:
    Entry(RunningCalls* calls, const CallOrigin& origin, std::string request_id, bool is_stream,
          const grpc::ServerContextBase* context);
    ~Entry();
    Entry(const Entry&) = delete;
    Entry& operator=(const Entry&) = delete;

   private:
    RunningCalls* const calls_;
    const std::string stream_client_;  // empty: no stream
    const grpc::ServerContextBase* const context_;
    Calls::iterator place_;
  };

  int NumStreams(const std::string& client);

  // The id of the request that a call makes (request_scope.h); empty for a call that is not here.
  std::string RequestIdOf(const grpc::ServerContextBase& context);

  // Notes the project that a call was let into. It does nothing for a call that is not here.
  void NoteProject(const grpc::ServerContextBase& context, const std::string& project);
  // The project that a call was let into; empty: none.
  std::string ProjectOf(const grpc::ServerContextBase& context);

  // Cancels the calls of all tokens for which `is_good` says no. It asks once for each token.
  void CancelUnless(const std::function<bool(const std::string& token_id)>& is_good);

 private:
  std::mutex mutex_;                    // never held while a call is cancelled
  Calls calls_;                         // guarded by mutex_
  std::map<std::string, int> streams_;  // by client, none is 0; guarded by mutex_
  std::map<const grpc::ServerContextBase*, std::shared_ptr<Call>> by_context_;  // guarded by mutex_
};

}  // namespace pleat
