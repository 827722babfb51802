// Who may call what.
#pragma once

#include <grpcpp/server_context.h>

#include <string>
#include <string_view>
#include <utility>

#include "absl/status/statusor.h"
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

// Returns the context of the caller's project when the call may go on: that of its token, or the
// default project where no tokens are required. kUnauthenticated without a good token where they
// are, and kPermissionDenied when the token does not have the scope of the RPC. This is the only
// place that decides what a call can see.
absl::StatusOr<HandlerContext*> Admit(HandlerContext* context, const grpc::ServerContextBase& call,
                                      const char* rpc);

// The same for what is no call of gRPC: the page of a browser, which shows its token otherwise.
// shared: as SharedContentOf. A caller that shows no good token sees that content then, in place of
// an error, and can change nothing.
absl::StatusOr<HandlerContext*> AdmitToken(HandlerContext* context, const std::string& token_text,
                                           const std::string& shared, const char* rpc);

// The same for a stream. kResourceExhausted when its client has too many others.
absl::StatusOr<HandlerContext*> AdmitStream(HandlerContext* context,
                                            const grpc::ServerContextBase& call, const char* rpc);

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

// Starts the stream with `start`, which gets the context of the caller's project, or one that says
// why it is refused.
template <typename GrpcReactor, typename Start>
GrpcReactor* StartAdmitted(HandlerContext* context, const grpc::ServerContextBase& call,
                           const char* rpc, Start start) {
  RequestTag request{.id = context->calls->running_calls.RequestIdOf(call)};
  const RequestScope scope(request);
  absl::StatusOr<HandlerContext*> admitted = AdmitStream(context, call, rpc);
  if (admitted.ok()) {
    request.project = (*admitted)->project;
    return start(*admitted);
  }
  return StartReactor<RefusedStream<GrpcReactor>>(context, rpc, std::move(admitted).status());
}

}  // namespace pleat
