#include "pleat/cache/charge_account.h"

#include "absl/strings/str_cat.h"

namespace pleat {

absl::Status ChargeAccount::Charge(uint64_t bytes, const std::string& key) {
  if (Fits(bytes)) {
    used_bytes_ += bytes;
    return absl::OkStatus();
  }
  if (bytes > capacity_bytes_) {
    return absl::ResourceExhaustedError(
        absl::StrCat("'", key, "' needs ", bytes, " bytes of cache, the whole cache has ",
                     capacity_bytes_, "; start the server with a larger --cache-bytes"));
  }
  return absl::ResourceExhaustedError(absl::StrCat(
      "'", key, "' needs ", bytes, " bytes of cache, but ", used_bytes_, " of ", capacity_bytes_,
      " are in use by running calls; try again later or start the "
      "server with a larger --cache-bytes"));
}

}  // namespace pleat
