// Which requests come from the page of this server, and which from a foreign page in the same
// browser (docs/security.md).
#pragma once

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "pleat/http/http_message.h"

namespace pleat {

// What a request is for.
enum class RequestKind {
  kPage,    // a file of the page: no secret, and links from elsewhere may lead to it
  kCall,    // everything else
  kSocket,  // an upgrade to a WebSocket
};

// The marker of calls: a header that a foreign page cannot set without asking this server first,
// which never agrees.
inline constexpr char kCallMarker[] = "x-pleat-studio";

// OK when the request is for one of `hosts` ("127.0.0.1:7321", lower case), and not from a page of
// another origin. kPermissionDenied says what is wrong.
absl::Status CheckRequest(const HttpRequest& request, RequestKind kind,
                          const std::vector<std::string>& hosts);

// The hosts that a server at `address` (HOST:PORT) answers for: of a loopback address all names of
// this machine, and the further ones.
std::vector<std::string> HostsOf(const std::string& address, const std::vector<std::string>& more);

}  // namespace pleat
