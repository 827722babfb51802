#include "exposure.h"

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"

namespace pleat {

bool IsLocalAddress(const std::string& listen) {
  if (absl::StartsWith(listen, "unix:")) return true;
  const std::string host = listen.substr(0, listen.rfind(':'));
  return host == "localhost" || host == "[::1]" || host == "::1" || absl::StartsWith(host, "127.");
}

absl::Status CheckExposure(const Exposure& exposure) {
  if (IsLocalAddress(exposure.listen)) return absl::OkStatus();
  if (!exposure.encrypted && !exposure.allow_unencrypted) {
    return absl::FailedPreconditionError(absl::StrCat(
        "other machines could reach ", exposure.listen,
        " in plain text; give --tls-cert and "
        "--tls-key, listen on 127.0.0.1, or say --allow-unencrypted where the network is trusted"));
  }
  if (exposure.is_root && !exposure.allow_root) {
    return absl::FailedPreconditionError(absl::StrCat("other machines could reach ",
                                                      exposure.listen,
                                                      " of a server that runs as root; run it as "
                                                      "a user of its own, or say --allow-root"));
  }
  return absl::OkStatus();
}

}  // namespace pleat
