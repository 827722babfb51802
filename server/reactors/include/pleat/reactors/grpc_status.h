// The one mapping from Pleat's errors to gRPC's.
#pragma once

#include <grpcpp/support/status.h>

#include "absl/status/status.h"

namespace pleat {

// Codes are the same by number; the message is cut to what fits into a trailer.
grpc::Status ToGrpcStatus(const absl::Status& status);

}  // namespace pleat
