#include <pybind11/stl.h>

#include <optional>
#include <string>

#include "bindings.h"
#include "pleat/character/experiment.h"
#include "python_error.h"

namespace py = pybind11;

namespace pleat {
namespace {

py::dict ErrorsOf(const ErrorSummary& errors) {
  return py::dict(py::arg("mean_percent") = errors.mean_percent,
                  py::arg("frame_mean_percent") = errors.frame_mean_percent);
}

// What was measured: errors by the name of the method.
py::dict ReportOf(const EvaluateReport& report) {
  py::dict errors(py::arg("skinned") = ErrorsOf(report.skinned),
                  py::arg("hybrid") = ErrorsOf(report.hybrid));
  py::dict learners;
  for (const auto& [name, summary] : report.learners) learners[name.c_str()] = ErrorsOf(summary);
  return py::dict(py::arg("protocol") = report.protocol, py::arg("learner") = report.learner,
                  py::arg("num_train_frames") = report.num_train_frames,
                  py::arg("num_control_vertices") = report.num_control_vertices,
                  py::arg("test_frames") = report.test_frames, py::arg("errors") = errors,
                  py::arg("learners") = learners);
}

// The rows of one of the paper's comparisons.
py::list RunNamedExperiment(const MeshSequence& sequence, const std::string& name,
                            const std::string& protocol, bool paper_options, int num_threads,
                            const py::object& progress) {
  const Experiment experiment = ValueOrThrow(ParseExperiment(name));
  EvaluateOptions options;
  options.protocol = ValueOrThrow(ParseEvaluationProtocol(protocol));
  if (paper_options) options.train = TrainOptions::Paper();
  options.resources.num_threads = num_threads;
  PythonProgress report(progress);
  absl::StatusOr<ExperimentReport> found;
  {
    const py::gil_scoped_release unlock;
    found = RunExperiment(sequence, std::nullopt, experiment, options, report.token());
  }
  report.Check();
  py::list rows;
  for (const ExperimentRow& row : ValueOrThrow(std::move(found)).rows) {
    rows.append(py::dict(py::arg("group") = row.variant.group, py::arg("name") = row.variant.name,
                         py::arg("report") = ReportOf(row.report)));
  }
  return rows;
}

}  // namespace

void BindExperiments(py::module_& module) {
  module.def("experiment_names", &ExperimentNames);
  module.def("experiment", &RunNamedExperiment, py::arg("sequence"), py::arg("name"),
             py::arg("protocol"), py::arg("paper_options"), py::arg("num_threads"),
             py::arg("progress"));
}

}  // namespace pleat
