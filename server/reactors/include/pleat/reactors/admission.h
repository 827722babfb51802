// Who may call what.
#pragma once

#include <grpcpp/server_context.h>

#include <string>
#include <string_view>
#include <utility>

#include "absl/status/status.h"
#include "pleat/identity/scope.h"
#include "pleat/reactors/call_reactor.h"
#include "pleat/reactors/grpc_status.h"
#include "pleat/reactors/handler_context.h"
#include "pleat/reactors/run_unary.h"

namespace pleat {

// What is said about an RPC outside of its handler.
struct RpcRule {
  std::string_view rpc;  // "DeleteModel"; no two services have an RPC of the same name
  Scope scope;           // what a token must allow
  // Whether a call leaves a line in the audit log: those that change something, and those that give
  // away content. Refused calls always do.
  bool audited;
};

// Null for an RPC that is not Pleat's, such as the health check, which needs no token.
const RpcRule* FindRpcRule(std::string_view rpc);

// The text of the token that a call shows, without "Bearer "; empty when it shows none.
std::string ShownToken(const grpc::ServerContextBase& call);

// OK when the call may go on. kUnauthenticated without a good token where tokens are required, and
// kPermissionDenied when the token does not have the scope of the RPC.
absl::Status Admit(const HandlerContext& context, const grpc::ServerContextBase& call,
                   const char* rpc);

// The same for a stream. kResourceExhausted when its client has too many others.
absl::Status AdmitStream(HandlerContext* context, const grpc::ServerContextBase& call,
                         const char* rpc);

// A stream that ends before it begins.
template <typename GrpcReactor>
class RefusedStream final : public CallReactor<GrpcReactor> {
 public:
  RefusedStream(HandlerContext* context, const char* rpc, absl::Status status)
      : CallReactor<GrpcReactor>(context), rpc_(rpc), status_(std::move(status)) {}
  void Start() {
    LogFailure(rpc_, status_);
    this->Finish(ToGrpcStatus(status_));
  }

 private:
  const char* const rpc_;
  const absl::Status status_;
};

// Starts the stream with `start`, or one that says why it is refused.
template <typename GrpcReactor, typename Start>
GrpcReactor* StartAdmitted(HandlerContext* context, const grpc::ServerContextBase& call,
                           const char* rpc, Start start) {
  absl::Status status = AdmitStream(context, call, rpc);
  if (status.ok()) return start();
  return StartReactor<RefusedStream<GrpcReactor>>(context, rpc, std::move(status));
}

}  // namespace pleat
