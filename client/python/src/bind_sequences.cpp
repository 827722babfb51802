#include <pybind11/stl.h>

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/strings/str_cat.h"
#include "arrays.h"
#include "bindings.h"
#include "pleat/formats/sequence_file.h"
#include "pleat/formats/sequence_reader.h"
#include "pleat/performer/performer.h"
#include "python_error.h"

namespace py = pybind11;

namespace pleat {
namespace {

// Rows of one length (F x 3, F x 4), or the corners of all faces with their sizes.
Topology TakeFaces(int num_vertices, const TakenArray<int32_t>& faces, const py::object& sizes) {
  std::vector<int32_t> corners(faces.data(), faces.data() + faces.size());
  if (!sizes.is_none()) {
    const auto given = py::cast<TakenArray<int32_t>>(sizes);
    CheckShape(faces, {-1}, "faces with face_sizes");
    CheckShape(given, {-1}, "face_sizes");
    return ValueOrThrow(
        Topology::Create(num_vertices, std::move(corners),
                         std::vector<int32_t>(given.data(), given.data() + given.size())));
  }
  CheckShape(faces, {-1, -1}, "faces");
  std::vector<int32_t> same(static_cast<size_t>(faces.shape(0)),
                            static_cast<int32_t>(faces.shape(1)));
  return ValueOrThrow(Topology::Create(num_vertices, std::move(corners), std::move(same)));
}

FrameRate TakeFrameRate(const py::object& fps) {
  const py::object fraction =
      py::module_::import("fractions").attr("Fraction")(fps).attr("limit_denominator")(1001);
  return {py::cast<int32_t>(fraction.attr("numerator")),
          py::cast<int32_t>(fraction.attr("denominator"))};
}

MeshSequence MakeSequence(const TakenArray<float>& positions, const TakenArray<int32_t>& faces,
                          const py::object& fps, const std::string& name,
                          const py::object& face_sizes) {
  CheckShape(positions, {-1, -1, 3}, "positions");
  const auto num_vertices = static_cast<int>(positions.shape(1));
  Topology topology = TakeFaces(num_vertices, faces, face_sizes);
  std::vector<Eigen::Matrix3Xf> frames;
  for (py::ssize_t t = 0; t < positions.shape(0); ++t) {
    frames.emplace_back(
        Eigen::Map<const Eigen::Matrix3Xf>(positions.data(t), 3, positions.shape(1)));
  }
  return ValueOrThrow(MeshSequence::Create(std::move(topology), std::move(frames),
                                           {.name = name, .frame_rate = TakeFrameRate(fps)}));
}

py::array_t<float> PositionsOf(const MeshSequence& sequence) {
  auto array = NewArray<float>({sequence.num_frames(), sequence.num_vertices(), 3});
  for (int t = 0; t < sequence.num_frames(); ++t) {
    std::copy_n(sequence.frame(t).data(), sequence.frame(t).size(), array.mutable_data(t));
  }
  return array;
}

template <typename Value>
py::array_t<Value> ArrayOf(const std::vector<Value>& values) {
  return py::array_t<Value>(static_cast<py::ssize_t>(values.size()), values.data());
}

std::vector<int32_t> FaceSizesOf(const Topology& topology) {
  std::vector<int32_t> sizes;
  for (int f = 0; f < topology.num_faces(); ++f) {
    sizes.push_back(static_cast<int32_t>(topology.face(f).size()));
  }
  return sizes;
}

// The sequence and what its reader says about it.
py::tuple Read(const std::string& path, const std::optional<py::object>& fps,
               const std::string& object, const py::object& progress) {
  ReadSequenceOptions options{.object = object};
  if (fps) options.frame_rate = TakeFrameRate(*fps);
  PythonProgress report(progress);
  InputReport notes;
  absl::StatusOr<MeshSequence> sequence;
  {
    const py::gil_scoped_release unlock;
    sequence = ReadSequence(path, options, report.token(), &notes);
  }
  report.Check();
  MeshSequence taken = ValueOrThrow(std::move(sequence));
  std::vector<std::string> texts;
  for (const InputNote& note : notes.notes) texts.push_back(note.text);
  return py::make_tuple(std::move(taken), texts);
}

py::bytes BytesOf(const MeshSequence& sequence) {
  std::string bytes;
  {
    const py::gil_scoped_release unlock;
    bytes = EncodeSequence(sequence);
  }
  return py::bytes(bytes);
}

MeshSequence SequenceOf(const py::bytes& data) {
  const std::string_view bytes = data;
  const py::gil_scoped_release unlock;  // the caller holds `data`
  return ValueOrThrow(DecodeSequence(bytes));
}

MeshSequence MakePerformer(int num_frames, int num_vertices, uint64_t seed) {
  const py::gil_scoped_release unlock;
  return ValueOrThrow(GeneratePerformer(
                          {.seed = seed, .num_frames = num_frames, .num_vertices = num_vertices}))
      .sequence;
}

}  // namespace

void BindSequences(py::module_& module) {
  py::class_<MeshSequence>(module, "Sequence")
      .def(py::init(&MakeSequence), py::arg("positions"), py::arg("faces"), py::kw_only(),
           py::arg("fps") = 30, py::arg("name") = "", py::arg("face_sizes") = py::none())
      .def_property_readonly("positions", &PositionsOf)
      .def_property_readonly("triangles",
                             [](const MeshSequence& sequence) {
                               const Eigen::Matrix3Xi& triangles = sequence.topology().triangles();
                               auto array = NewArray<int32_t>({triangles.cols(), 3});
                               std::copy_n(triangles.data(), triangles.size(),
                                           array.mutable_data());
                               return array;
                             })
      .def_property_readonly("corners",
                             [](const MeshSequence& sequence) {
                               return ArrayOf(sequence.topology().corner_vertices());
                             })
      .def_property_readonly(
          "face_sizes",
          [](const MeshSequence& sequence) { return ArrayOf(FaceSizesOf(sequence.topology())); })
      .def_property_readonly("fps",
                             [](const MeshSequence& sequence) {
                               const FrameRate rate = sequence.frame_rate();
                               return py::module_::import("fractions")
                                   .attr("Fraction")(rate.numerator, rate.denominator);
                             })
      .def_property_readonly("name", &MeshSequence::name)
      .def_property_readonly("num_frames", &MeshSequence::num_frames)
      .def_property_readonly("num_vertices", &MeshSequence::num_vertices)
      .def("__len__", &MeshSequence::num_frames)
      .def("to_bytes", &BytesOf)
      .def_static("from_bytes", &SequenceOf, py::arg("data"))
      .def("frame",
           [](const MeshSequence& sequence, int t) {
             if (t < 0 || t >= sequence.num_frames()) throw py::index_error("no such frame");
             auto array = NewArray<float>({sequence.num_vertices(), 3});
             std::copy_n(sequence.frame(t).data(), sequence.frame(t).size(), array.mutable_data());
             return array;
           })
      .def("subset", [](const MeshSequence& sequence, const std::vector<int>& frames) {
        for (const int t : frames) {
          if (t < 0 || t >= sequence.num_frames()) {
            throw py::index_error(absl::StrCat("there is no frame ", t));
          }
        }
        if (frames.empty()) throw py::index_error("a subset needs a frame");
        return sequence.Subset(frames);
      });
  module.def("read", &Read, py::arg("path"), py::arg("fps"), py::arg("object"),
             py::arg("progress"));
  module.def("performer", &MakePerformer, py::arg("num_frames"), py::arg("num_vertices"),
             py::arg("seed"));
}

}  // namespace pleat
