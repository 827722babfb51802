// Status helpers shared by every module. An absl::Status says what failed, where, why, and what to
// do.
#pragma once

#include <utility>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace pleat {

// The same error with "where: " in front of its message; OK stays OK.
absl::Status WithContext(absl::string_view where, absl::Status status);

// The error of a system call: "message: the system's words for `code`", where `code` is an errno.
// Codes that are rare are never kUnknown, which would blame Pleat for what a disk or a path does.
absl::Status ErrnoStatus(int code, absl::string_view message);

template <typename T>
absl::StatusOr<T> WithContext(absl::string_view where, absl::StatusOr<T> value) {
  if (value.ok()) return value;
  return WithContext(where, std::move(value).status());
}

}  // namespace pleat

// Returns from the enclosing function when `expression` (an absl::Status) is not OK.
#define PLEAT_RETURN_IF_ERROR(expression)                                                  \
  do {                                                                                     \
    if (absl::Status pleat_status = (expression); !pleat_status.ok()) return pleat_status; \
  } while (false)

#define PLEAT_STATUS_CONCAT_INNER(a, b) a##b
#define PLEAT_STATUS_CONCAT(a, b) PLEAT_STATUS_CONCAT_INNER(a, b)

// PLEAT_ASSIGN_OR_RETURN(auto mesh, ReadMesh(path)); assigns the value or returns the error. It
// expands to several statements, so it cannot be the body of an `if` without braces.
#define PLEAT_ASSIGN_OR_RETURN(declaration, expression)                         \
  auto PLEAT_STATUS_CONCAT(pleat_status_or_, __LINE__) = (expression);          \
  if (!PLEAT_STATUS_CONCAT(pleat_status_or_, __LINE__).ok())                    \
    return std::move(PLEAT_STATUS_CONCAT(pleat_status_or_, __LINE__)).status(); \
  declaration = std::move(PLEAT_STATUS_CONCAT(pleat_status_or_, __LINE__)).value()
