// The oldest version of TLS that is spoken.
#pragma once

#include "absl/status/status.h"

namespace pleat {

// From here on, TLS connections of this process that OpenSSL makes speak version 1.3 or later. Call
// it before gRPC makes credentials.
absl::Status RequireTls13();

}  // namespace pleat
