#include "exposure.h"

#include "absl/strings/str_cat.h"
#include "pleat/base/address.h"

namespace pleat {

absl::Status CheckExposure(const Exposure& exposure) {
  if (IsLocalAddress(exposure.listen)) return absl::OkStatus();
  if (!exposure.encrypted && !exposure.allow_unencrypted) {
    return absl::FailedPreconditionError(absl::StrCat(
        "other machines could reach ", exposure.listen,
        " in plain text; give --tls-cert and "
        "--tls-key, listen on 127.0.0.1, or say --allow-unencrypted where the network is trusted"));
  }
  if (!exposure.knows_callers && !exposure.allow_anonymous) {
    return absl::FailedPreconditionError(absl::StrCat(
        "whoever reaches ", exposure.listen,
        " could read and delete everything; make tokens with 'pleat token create', or ask for "
        "certificates with --tls-client-ca, or say --allow-anonymous where the network is "
        "trusted"));
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
