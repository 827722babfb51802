// Addresses of servers as people write them: HOST:PORT, or unix:PATH.
#pragma once

#include <string_view>

namespace pleat {

// "HOST:PORT" without its port, "[::1]:7320" without its brackets too; all of an address that has
// no port.
std::string_view HostOf(std::string_view address);

// True of unix sockets and of loopback addresses, which only this machine reaches.
bool IsLocalAddress(std::string_view address);

}  // namespace pleat
