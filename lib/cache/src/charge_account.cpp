#include "pleat/cache/charge_account.h"

#include "absl/strings/str_cat.h"

namespace pleat {

absl::StatusOr<Reservation> ChargeAccount::Charge(uint64_t bytes, const std::string& key) {
  return budget_.ReserveUnused(bytes, absl::StrCat("'", key, "' in the cache"));
}

}  // namespace pleat
