#include <pybind11/stl.h>

#include <memory>
#include <string>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "pleat/rigging/auto_rig.h"
#include "python_error.h"

namespace py = pybind11;

namespace pleat {
namespace {

// A rig and what is known about its quality.
struct FoundRig {
  Rig rig;
  AutoRigSummary summary;
};

FoundRig FindRig(const MeshSequence& sequence, int rest_frame, int num_threads,
                 const py::object& progress) {
  PythonProgress report(progress);
  AutoRigOptions options;
  options.rest_frame = rest_frame;
  options.num_threads = num_threads;
  AutoRigSummary summary;
  absl::StatusOr<Rig> rig;
  {
    const py::gil_scoped_release unlock;
    rig = AutoRig(sequence, options, &summary, report.token());
  }
  report.Check();
  return {ValueOrThrow(std::move(rig)), std::move(summary)};
}

py::array_t<double> RowsOfColumns(const Eigen::Matrix3Xd& columns) {
  auto array = NewArray<double>({columns.cols(), 3});
  std::copy_n(columns.data(), columns.size(), array.mutable_data());
  return array;
}

}  // namespace

void BindRigs(py::module_& module) {
  py::class_<FoundRig>(module, "Rig")
      .def_property_readonly("joint_names",
                             [](const FoundRig& found) {
                               std::vector<std::string> names;
                               for (const Joint& joint : found.rig.skeleton.joints()) {
                                 names.push_back(joint.name);
                               }
                               return names;
                             })
      .def_property_readonly("parents",
                             [](const FoundRig& found) {
                               std::vector<int> parents;
                               for (const Joint& joint : found.rig.skeleton.joints()) {
                                 parents.push_back(joint.parent);
                               }
                               return parents;
                             })
      .def_property_readonly(
          "joint_positions",
          [](const FoundRig& found) { return RowsOfColumns(found.rig.skeleton.RestPositions()); })
      .def_property_readonly(
          "rest_positions",
          [](const FoundRig& found) { return RowsOfColumns(found.rig.rest_positions); })
      .def_property_readonly("weights",
                             [](const FoundRig& found) {
                               const Eigen::MatrixXd dense = found.rig.weights.ToDense();
                               auto array = NewArray<double>({dense.rows(), dense.cols()});
                               for (Eigen::Index v = 0; v < dense.rows(); ++v) {
                                 for (Eigen::Index j = 0; j < dense.cols(); ++j) {
                                   *array.mutable_data(v, j) = dense(v, j);
                                 }
                               }
                               return array;
                             })
      .def_property_readonly("rest_frame",
                             [](const FoundRig& found) { return found.summary.rest_frame; })
      .def_property_readonly("residual",
                             [](const FoundRig& found) { return found.summary.residual; })
      .def_property_readonly("warnings",
                             [](const FoundRig& found) { return found.summary.warnings; });
  module.def("rig", &FindRig, py::arg("sequence"), py::arg("rest_frame"), py::arg("num_threads"),
             py::arg("progress"));
}

}  // namespace pleat
