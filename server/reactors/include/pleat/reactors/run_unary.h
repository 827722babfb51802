// Runs a unary handler on an executor and finishes its call.
#pragma once

#include <grpcpp/support/server_callback.h>

#include <functional>

#include "absl/status/status.h"
#include "pleat/reactors/handler_context.h"

namespace pleat {

// `handler` runs on `executor`, not on the network thread; request and response live until then.
// A call that was cancelled while it waited is not run, nor one that comes while the server shuts
// down. Exceptions become a status.
grpc::ServerUnaryReactor* RunUnary(HandlerContext* context, grpc::CallbackServerContext* call,
                                   Executor* executor, const char* rpc,
                                   std::function<absl::Status()> handler);

// handler(), with exceptions (no memory) as a status.
absl::Status CallGuarded(const std::function<absl::Status()>& handler);

// One log line per failed call.
void LogFailure(const char* rpc, const absl::Status& status);

}  // namespace pleat
