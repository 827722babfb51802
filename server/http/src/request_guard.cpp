#include "request_guard.h"

#include <algorithm>
#include <string_view>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "pleat/base/address.h"
#include "pleat/base/utf8.h"

namespace pleat {
namespace {

bool IsOneOf(const std::vector<std::string>& hosts, std::string_view host) {
  return std::ranges::find(hosts, absl::AsciiStrToLower(std::string(host))) != hosts.end();
}

// The host of "http://HOST:PORT"; empty for anything else, such as "null".
std::string_view HostOfOrigin(std::string_view origin) {
  for (const std::string_view scheme : {"http://", "https://"}) {
    if (origin.starts_with(scheme)) return origin.substr(scheme.size());
  }
  return {};
}

}  // namespace

absl::Status CheckRequest(const HttpRequest& request, RequestKind kind,
                          const std::vector<std::string>& hosts) {
  // A foreign page whose name was pointed at this machine (DNS rebinding) shows its own name here.
  if (!IsOneOf(hosts, request.Header("host"))) {
    return absl::PermissionDeniedError(
        absl::StrCat("this server does not answer for '", EscapeControls(request.Header("host")),
                     "'; open http://", hosts.front(), ", or start it with --http-host"));
  }
  if (kind == RequestKind::kPage) return absl::OkStatus();
  const std::string& origin = request.Header("origin");
  const std::string& site = request.Header("sec-fetch-site");
  if ((!origin.empty() && !IsOneOf(hosts, HostOfOrigin(origin))) ||
      (!site.empty() && site != "same-origin" && site != "none")) {
    return absl::PermissionDeniedError(
        absl::StrCat("a page of '", EscapeControls(origin), "' may not use this server"));
  }
  if (kind == RequestKind::kCall && request.Header(kCallMarker).empty()) {
    return absl::PermissionDeniedError(
        absl::StrCat("calls need the header ", kCallMarker, ", which foreign pages cannot send"));
  }
  return absl::OkStatus();
}

std::vector<std::string> HostsOf(const std::string& address, const std::vector<std::string>& more) {
  std::vector<std::string> hosts{absl::AsciiStrToLower(address)};
  if (IsLocalAddress(address)) {
    const std::string port = address.substr(address.rfind(':'));
    for (const char* host : {"127.0.0.1", "localhost", "[::1]"}) hosts.push_back(host + port);
  }
  for (const std::string& host : more) hosts.push_back(absl::AsciiStrToLower(host));
  return hosts;
}

}  // namespace pleat
