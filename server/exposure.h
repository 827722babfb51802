// Whether the server may be reached as its command line asks.
#pragma once

#include <string>

#include "absl/status/status.h"

namespace pleat {

struct Exposure {
  std::string listen;  // HOST:PORT or unix:PATH
  bool encrypted = false;
  bool knows_callers = false;  // by tokens or by certificates of the clients
  bool is_root = false;
  bool allow_unencrypted = false;  // --allow-unencrypted
  bool allow_anonymous = false;    // --allow-anonymous
  bool allow_root = false;         // --allow-root
};

// An address that only this machine reaches needs nothing. For others, kFailedPrecondition names
// the flag that is missing when they could reach the server in plain text, or without saying who
// they are, or when it runs as root.
absl::Status CheckExposure(const Exposure& exposure);

}  // namespace pleat
