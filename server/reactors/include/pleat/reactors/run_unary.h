// Runs a unary handler on an executor and finishes its call.
#pragma once

#include <grpcpp/support/server_callback.h>

#include <functional>

#include "absl/status/status.h"
#include "pleat/reactors/handler_context.h"

namespace pleat {

// `handler` runs on `executor`, not on the network thread; the request and the response live until
// it has returned. A call that was cancelled while it waited is not run, and neither is one that
// comes while the server shuts down or that may not call `rpc` (admission.h). Exceptions become a
// status. The calls of one connection take turns with those of the others.
grpc::ServerUnaryReactor* RunUnary(HandlerContext* context, grpc::CallbackServerContext* call,
                                   Executor* executor, const char* rpc,
                                   std::function<absl::Status()> handler);

// Runs `handler` and turns its exceptions, such as a lack of memory, into a status.
absl::Status CallGuarded(const std::function<absl::Status()>& handler);

// Writes one log line when `status` is an error: as an error when the server is to blame for it.
void LogFailure(const char* rpc, const absl::Status& status);

}  // namespace pleat
