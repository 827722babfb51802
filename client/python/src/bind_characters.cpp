#include <pybind11/stl.h>

#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "bindings.h"
#include "character_object.h"
#include "pleat/character/fit_motion.h"
#include "pleat/character/train_character.h"
#include "pleat/formats/model_file.h"
#include "pleat/formats/motion_file.h"
#include "python_error.h"

namespace py = pybind11;

namespace pleat {
namespace {

// Options as "name=value" lines, which have the names and checks of all other doors.
TrainOptions TakeOptions(const py::dict& options) {
  std::string lines;
  for (const auto& [name, value] : options) {
    absl::StrAppend(&lines, py::cast<std::string>(py::str(name)), "=",
                    py::cast<std::string>(py::str(value)), "\n");
  }
  return ValueOrThrow(ParseTrainOptions(lines));
}

CharacterObject Train(const std::vector<MeshSequence>& clips, const py::dict& options,
                      int num_threads, const py::object& progress) {
  const TrainOptions taken = TakeOptions(options);
  ThrowIfError(ValidateTrainOptions(taken));
  PythonProgress report(progress);
  absl::StatusOr<std::shared_ptr<const CharacterModel>> model;
  {
    const py::gil_scoped_release unlock;
    model = TrainCharacter(clips, taken, {.num_threads = num_threads}, nullptr, report.token());
  }
  report.Check();
  return CharacterObject(ValueOrThrow(std::move(model)));
}

CharacterObject FromBytes(const std::string& bytes) {
  return CharacterObject(ValueOrThrow(DecodeModel(bytes)));
}

py::bytes ToBytes(const CharacterObject& character) {
  return py::bytes(EncodeModel(*character.model()));
}

PoseTrack Fit(const CharacterObject& character, const MeshSequence& sequence, int num_threads,
              const py::object& progress) {
  PythonProgress report(progress);
  absl::StatusOr<PoseTrack> track;
  {
    const py::gil_scoped_release unlock;
    track = FitMotion(*character.model(), sequence, {.num_threads = num_threads}, report.token());
  }
  report.Check();
  return ValueOrThrow(std::move(track));
}

py::dict RecordOf(const CharacterObject& character) {
  const TrainingRecord& record = character.model()->record();
  return py::dict(py::arg("learner") = record.learner, py::arg("num_frames") = record.num_frames,
                  py::arg("rest_frame") = record.rest_frame,
                  py::arg("rig_residual") = record.rig_residual,
                  py::arg("diagonal_m") = record.diagonal_m,
                  py::arg("skinned_mean_percent") = record.fit.mean_percent,
                  py::arg("mean_percent") = record.reconstruction.mean_percent,
                  py::arg("warnings") = record.warnings);
}

}  // namespace

void BindCharacters(py::module_& module) {
  py::class_<CharacterObject>(module, "Character")
      .def_static("from_bytes", &FromBytes, py::arg("data"))
      .def("to_bytes", &ToBytes)
      .def_property_readonly(
          "name", [](const CharacterObject& character) { return character.model()->name(); })
      .def_property_readonly("joint_names", &CharacterObject::joint_names)
      .def_property_readonly("parents", &CharacterObject::parents)
      .def_property_readonly("joint_positions", &CharacterObject::joint_positions)
      .def_property_readonly("triangles", &CharacterObject::triangles)
      .def_property_readonly("num_vertices", &CharacterObject::num_vertices)
      .def_property_readonly("num_joints", &CharacterObject::num_joints)
      .def_property_readonly("num_coefficients", &CharacterObject::num_coefficients)
      .def_property_readonly("history", &CharacterObject::history)
      .def_property_readonly(
          "fps",
          [](const CharacterObject& character) { return character.model()->frame_rate().fps(); })
      .def_property_readonly("record", &RecordOf)
      .def("fit", &Fit, py::arg("sequence"), py::kw_only(), py::arg("threads") = 0,
           py::arg("progress") = py::none())
      .def("evaluate", &CharacterObject::EvaluateMotion, py::arg("motion"), py::kw_only(),
           py::arg("bone_scales") = std::vector<double>(), py::arg("skinned_only") = false,
           py::arg("out") = py::none(), py::arg("progress") = py::none())
      .def("evaluate_poses", &CharacterObject::EvaluatePoses, py::arg("root_positions"),
           py::arg("rotations"), py::kw_only(), py::arg("bone_scales") = std::vector<double>(),
           py::arg("skinned_only") = false, py::arg("out") = py::none())
      .def("predict", &CharacterObject::Predict, py::arg("root_positions"), py::arg("rotations"),
           py::kw_only(), py::arg("skinned_only") = false)
      .def("show", &CharacterObject::Show, py::arg("root_positions"), py::arg("rotations"),
           py::arg("coefficients"), py::kw_only(), py::arg("bone_scales") = std::vector<double>(),
           py::arg("out") = py::none());
  module.def("train", &Train, py::arg("clips"), py::arg("options"), py::arg("num_threads"),
             py::arg("progress"));
}

}  // namespace pleat
