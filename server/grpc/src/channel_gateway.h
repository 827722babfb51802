// The gateway over a channel of this process.
#pragma once

#include <memory>

#include "pleat/grpc/call_gateway.h"
#include "pleat/reactors/running_calls.h"

namespace grpc {
class Channel;
}

namespace pleat {

std::unique_ptr<CallGateway> MakeChannelGateway(std::shared_ptr<grpc::Channel> channel);

}  // namespace pleat
