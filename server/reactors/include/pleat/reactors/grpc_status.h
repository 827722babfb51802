// The one mapping from Pleat's errors to those of gRPC.
#pragma once

#include <grpcpp/support/status.h>

#include "absl/status/status.h"

namespace pleat {

// The codes are the same numbers. The message is cut to what fits into a trailer and is valid
// UTF-8. A refusal for a limit carries google.rpc.QuotaFailure and, when waiting helps, RetryInfo.
grpc::Status ToGrpcStatus(const absl::Status& status);

}  // namespace pleat
