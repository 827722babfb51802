// Calls of pages that anyone may open: without a token they see what a link shares.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "pleat/grpc/call_gateway.h"

namespace pleat {

// Says with every call which content that is.
class SharedGateway final : public CallGateway {
 public:
  // ids: as ForeignCaller::shared.
  SharedGateway(CallGateway* gateway, std::string ids) : gateway_(gateway), ids_(std::move(ids)) {}

  ForeignCaller Restricted(ForeignCaller caller) const {
    caller.shared = ids_;
    return caller;
  }
  std::unique_ptr<GatewayCall> Start(const std::string& method,
                                     const ForeignCaller& caller) override {
    return gateway_->Start(method, Restricted(caller));
  }
  std::shared_ptr<DuplexCall> Open(const std::string& method, const ForeignCaller& caller,
                                   DuplexListener listener) override {
    return gateway_->Open(method, Restricted(caller), std::move(listener));
  }

 private:
  CallGateway* const gateway_;
  const std::string ids_;
};

}  // namespace pleat
