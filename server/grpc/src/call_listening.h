// Tells a listener about every call, whatever its kind.
#pragma once

#include <grpcpp/support/server_interceptor.h>

#include <memory>
#include <vector>

#include "pleat/grpc/grpc_server.h"

namespace pleat {

// The listener must outlive the server that gets the factories.
std::vector<std::unique_ptr<grpc::experimental::ServerInterceptorFactoryInterface>>
MakeCallListening(const CallListener* listener);

}  // namespace pleat
