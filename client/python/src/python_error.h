// Errors on their way into Python.
#pragma once

#include <pybind11/pybind11.h>

#include <exception>
#include <functional>
#include <utility>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "pleat/base/progress.h"

namespace pleat {

// Carries a status through pybind11, which turns it into the Python class pleat.Error.
class StatusException : public std::exception {
 public:
  explicit StatusException(absl::Status status);
  const char* what() const noexcept override { return message_.c_str(); }
  const absl::Status& status() const { return status_; }

 private:
  absl::Status status_;
  std::string message_;
};

// Makes pleat.Error and translates StatusException into it.
void BindErrors(pybind11::module_& module);

inline void ThrowIfError(const absl::Status& status) {
  if (!status.ok()) throw StatusException(status);
}
template <typename Value>
Value ValueOrThrow(absl::StatusOr<Value> value) {
  if (!value.ok()) throw StatusException(std::move(value).status());
  return *std::move(value);
}

// A token that calls `report(stage, fraction)`, which may be none, and stops when Python raises:
// what the function raised, or an interrupt from the keyboard, is raised again by `Check`. It takes
// the lock of the interpreter, which the computation does not hold.
class PythonProgress {
 public:
  explicit PythonProgress(pybind11::object report) : report_(std::move(report)) {}
  Progress token();
  // Raises what was raised in between. Call it with the lock.
  void Check();

 private:
  void Report(const ProgressUpdate& update);

  pybind11::object report_;
  std::exception_ptr raised_;
};

}  // namespace pleat
