#include "pleat/base/status.h"

#include <cerrno>

#include "absl/strings/cord.h"
#include "absl/strings/str_cat.h"

namespace pleat {

absl::Status WithContext(absl::string_view where, absl::Status status) {
  if (status.ok()) return status;
  absl::Status told(status.code(), absl::StrCat(where, ": ", status.message()));
  // What else it carries, such as the limit that it is about (limit_refusal.h), stays.
  status.ForEachPayload([&told](absl::string_view type, const absl::Cord& payload) {
    told.SetPayload(type, payload);
  });
  return told;
}

absl::Status ErrnoStatus(int code, absl::string_view message) {
  const absl::Status status = absl::ErrnoToStatus(code, message);
  if (!absl::IsUnknown(status)) return status;
  // What is left are names that lead in circles and, above all, disks and file systems that fail
  // (EIO, EUCLEAN, ...). kDataLoss is reserved for bytes that were read and are wrong.
  return absl::Status(
      code == ELOOP ? absl::StatusCode::kInvalidArgument : absl::StatusCode::kFailedPrecondition,
      status.message());
}

}  // namespace pleat
