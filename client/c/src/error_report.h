// Errors on their way out of the library: neither a status nor an exception crosses the boundary.
#pragma once

#include <utility>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "pleat.h"

namespace pleat {

// Fills `error`, which may be null, and returns the code. OK clears it.
pleat_code Report(const absl::Status& status, pleat_error* error) noexcept;

// Turns the exception that is being handled into a code: no memory, or a mistake of ours.
pleat_code ReportException(pleat_error* error) noexcept;

// Runs `call`, which returns an absl::Status, and reports what comes of it.
template <typename Call>
pleat_code Guarded(pleat_error* error, Call&& call) noexcept {
  try {
    return Report(std::forward<Call>(call)(), error);
  } catch (...) {
    return ReportException(error);
  }
}

// The error for an argument that must not be null.
inline absl::Status IsNull(absl::string_view argument) {
  return absl::InvalidArgumentError(absl::StrCat(argument, " is NULL"));
}

// kInvalidArgument when `struct_size` of the struct `name` is below that of the first header.
absl::Status CheckStructSize(absl::string_view name, size_t struct_size, size_t first_size);

}  // namespace pleat
