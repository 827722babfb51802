#include "pleat/base/address.h"

#include <algorithm>

namespace pleat {

std::string_view HostOf(std::string_view address) {
  // Without brackets, several colons are an IPv6 address that has no port.
  if (!address.starts_with('[') && std::ranges::count(address, ':') > 1) return address;
  const size_t colon = address.rfind(':');
  const size_t bracket = address.rfind(']');
  const bool has_port =
      colon != std::string_view::npos && (bracket == std::string_view::npos || bracket < colon);
  std::string_view host = has_port ? address.substr(0, colon) : address;
  if (host.size() >= 2 && host.front() == '[' && host.back() == ']') {
    host = host.substr(1, host.size() - 2);
  }
  return host;
}

bool IsLocalAddress(std::string_view address) {
  if (address.starts_with("unix:")) return true;
  const std::string_view host = HostOf(address);
  return host == "localhost" || host == "::1" || host.starts_with("127.");
}

}  // namespace pleat
