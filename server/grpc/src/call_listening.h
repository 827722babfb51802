// Tells a CallListener of every call, whatever its handler is.
#pragma once

#include <grpcpp/support/server_interceptor.h>

#include <memory>
#include <vector>

#include "pleat/grpc/grpc_server.h"
#include "pleat/reactors/running_calls.h"

namespace pleat {

// `running` receives the calls. Both must outlive the server; `listener` may be
// null.
std::vector<std::unique_ptr<grpc::experimental::ServerInterceptorFactoryInterface>>
MakeCallListening(const CallListener* listener, RunningCalls* running);

}  // namespace pleat
