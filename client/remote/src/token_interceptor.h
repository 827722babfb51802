// Shows a token with every call of a channel.
#pragma once

#include <grpcpp/support/client_interceptor.h>

#include <memory>
#include <string>

namespace pleat {

// gRPC's own call credentials want an encrypted channel, which a server on this machine need not
// have; Connect sees to it that a token leaves the machine only encrypted.
std::unique_ptr<grpc::experimental::ClientInterceptorFactoryInterface> ShowToken(
    const std::string& token);

}  // namespace pleat
