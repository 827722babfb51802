#include "python_error.h"

#include <string>

namespace py = pybind11;

namespace pleat {

StatusException::StatusException(absl::Status status)
    : status_(std::move(status)), message_(status_.message()) {}

void BindErrors(py::module_& module) {
  // Kept for the life of the process, as pybind11 keeps the classes that it registers.
  static py::handle error =
      py::exception<StatusException>(module, "Error", PyExc_RuntimeError).release();
  error.attr("__doc__") =
      "What went wrong, where, and what to do. `code` is the name of a status: INVALID_ARGUMENT, "
      "DATA_LOSS, RESOURCE_EXHAUSTED, ...";
  py::register_exception_translator([](std::exception_ptr pointer) {
    if (!pointer) return;
    try {
      std::rethrow_exception(pointer);
    } catch (const StatusException& exception) {
      py::object made = py::reinterpret_borrow<py::object>(error)(exception.what());
      made.attr("code") = absl::StatusCodeToString(exception.status().code());
      PyErr_SetObject(error.ptr(), made.ptr());
    }
  });
}

Progress PythonProgress::token() {
  return Progress([this](const ProgressUpdate& update) { Report(update); },
                  [this] { return raised_ != nullptr; });
}

void PythonProgress::Report(const ProgressUpdate& update) {
  const py::gil_scoped_acquire lock;
  if (raised_ != nullptr) return;
  try {
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    if (!report_.is_none()) report_(update.stage, update.fraction);
  } catch (...) {
    raised_ = std::current_exception();
  }
}

void PythonProgress::Check() {
  if (raised_ != nullptr) std::rethrow_exception(std::exchange(raised_, nullptr));
}

}  // namespace pleat
