// Whether the server may be reached as its command line asks.
#pragma once

#include <string>

#include "absl/status/status.h"

namespace pleat {

struct Exposure {
  std::string listen;  // HOST:PORT or unix:PATH
  bool encrypted = false;
  bool is_root = false;
  bool allow_unencrypted = false;  // --allow-unencrypted
  bool allow_root = false;         // --allow-root
};

// True of unix sockets and of loopback addresses, which only this machine reaches.
bool IsLocalAddress(const std::string& listen);

// kFailedPrecondition names the flag that is missing when other machines could reach the server in
// plain text, or reach one that runs as root.
absl::Status CheckExposure(const Exposure& exposure);

}  // namespace pleat
