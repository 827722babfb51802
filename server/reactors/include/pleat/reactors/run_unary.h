// Runs a unary handler on an executor and finishes its call.
#pragma once

#include <google/protobuf/message.h>
#include <grpcpp/support/server_callback.h>

#include <functional>

#include "absl/status/status.h"
#include "pleat/reactors/handler_context.h"

namespace pleat {

struct UnaryCall {
  HandlerContext* context =
      nullptr;  // of the server; the handler gets that of its caller's project
  grpc::CallbackServerContext* call = nullptr;
  Executor* executor = nullptr;
  const char* rpc = nullptr;
  // gRPC keeps both until the call has ended; their memory is charged to the budget of requests.
  const google::protobuf::Message* request = nullptr;
  const google::protobuf::Message* response = nullptr;
};
using UnaryHandler = std::function<absl::Status(HandlerContext& context)>;

// What a call takes while it waits for its turn, without its messages.
inline constexpr uint64_t kUnaryCallBytes = uint64_t{32} << 10;

// `handler` runs on the executor, not on the network thread; the request and the response live
// until it has returned. A call that was cancelled while it waited is not run, and neither is one
// that comes while the server shuts down. A call that may not be made (admission.h) or for which
// there is no memory ends at once, without waiting for a turn. Exceptions become a status. The
// calls of one connection take turns with those of the others.
grpc::ServerUnaryReactor* RunUnary(const UnaryCall& call, UnaryHandler handler);

// Runs `handler` and turns its exceptions, such as a lack of memory, into a status.
absl::Status CallGuarded(const std::function<absl::Status()>& handler);

// Writes one log line when `status` is an error: as an error when the server is to blame for it.
void LogFailure(const char* rpc, const absl::Status& status);

}  // namespace pleat
