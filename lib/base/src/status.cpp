#include "pleat/base/status.h"

#include "absl/strings/str_cat.h"

namespace pleat {

absl::Status WithContext(absl::string_view where, absl::Status status) {
  if (status.ok()) return status;
  return absl::Status(status.code(), absl::StrCat(where, ": ", status.message()));
}

}  // namespace pleat
