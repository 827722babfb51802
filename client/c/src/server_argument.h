// What sessions and calls to a server have in common.
#pragma once

#include "absl/status/status.h"
#include "pleat/remote/remote_options.h"

namespace pleat {

// token, tls_root_certificates: as in pleat_server_options, which may be null.
RemoteOptions TakeRemoteOptions(const char* token, const char* tls_root_certificates,
                                double connect_seconds);

// Says what it means that a server knows none of our calls; other errors stay as they are.
absl::Status NameOtherServers(absl::Status status, const char* address);

}  // namespace pleat
