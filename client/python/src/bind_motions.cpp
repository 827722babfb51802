#include <pybind11/stl.h>

#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "python_error.h"

namespace py = pybind11;

namespace pleat {
namespace {

PoseTrack MakeTrack(const TakenArray<double>& root_positions, const TakenArray<double>& rotations,
                    double fps) {
  CheckShape(rotations, {-1, -1, 4}, "rotations");
  CheckShape(root_positions, {rotations.shape(0), 3}, "root_positions");
  return ValueOrThrow(
      PoseTrack::Create({.fps = fps, .poses = TakePoses(root_positions, rotations)}));
}

}  // namespace

void BindMotions(py::module_& module) {
  py::class_<PoseTrack>(module, "Motion")
      .def(py::init(&MakeTrack), py::arg("root_positions"), py::arg("rotations"), py::kw_only(),
           py::arg("fps") = 30.0)
      .def_property_readonly("root_positions",
                             [](const PoseTrack& track) { return RootPositionsOf(track.poses()); })
      .def_property_readonly("rotations",
                             [](const PoseTrack& track) { return RotationsOf(track.poses()); })
      .def_property_readonly("fps", &PoseTrack::fps)
      .def_property_readonly("num_frames", &PoseTrack::num_frames)
      .def_property_readonly("num_joints", &PoseTrack::num_joints)
      .def("__len__", &PoseTrack::num_frames);
}

}  // namespace pleat
