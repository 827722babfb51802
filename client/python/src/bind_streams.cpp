// Frames of a server's streams: the bytes of Draco become positions.
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "arrays.h"
#include "bindings.h"
#include "pleat/stream/frame_decoder.h"
#include "python_error.h"

namespace py = pybind11;

namespace pleat {
namespace {

FrameEncoding TakeEncoding(int wire_number) {
  switch (wire_number) {  // of FrameEncoding in pose_service.proto
    case 1:
      return FrameEncoding::kDracoMesh;
    case 0:
    case 2:
      return FrameEncoding::kDracoPointCloud;
    case 3:
      return FrameEncoding::kDracoDelta;
    default:
      throw StatusException(absl::InvalidArgumentError(
          absl::StrCat("the stream has the encoding ", wire_number, ", which is not known here")));
  }
}

// Decodes the frames of one stream in their order.
class StreamDecoder {
 public:
  StreamDecoder(int encoding, int num_vertices, int num_points, int num_triangles,
                std::array<float, 3> origin, float range, int bits, const py::bytes& topology,
                const TakenArray<int32_t>& vertex_order) {
    StreamHeader header;
    header.encoding = TakeEncoding(encoding);
    header.num_vertices = num_vertices;
    header.num_points = num_points;
    header.num_triangles = num_triangles;
    header.box.origin_m = Eigen::Vector3f(origin[0], origin[1], origin[2]);
    header.box.range_m = range;
    header.box.bits = bits;
    header.topology = topology;
    header.vertex_order.assign(vertex_order.data(), vertex_order.data() + vertex_order.size());
    decoder_ =
        std::make_unique<FrameDecoder>(ValueOrThrow(FrameDecoder::Create(std::move(header))));
  }

  py::array_t<float> Decode(const py::bytes& draco, bool difference, uint32_t checksum,
                            const py::object& out) {
    py::array_t<float> target = TakeOut(out, {decoder_->header().num_vertices, 3});
    const std::string bytes = draco;
    float* const values = target.mutable_data();
    absl::Status status;
    {
      const py::gil_scoped_release unlock;
      const std::lock_guard lock(mutex_);  // threads of Python may share it by mistake
      status =
          decoder_->Decode(bytes, {.keyframe = !difference, .checksum = checksum}, &positions_);
      if (status.ok()) std::copy_n(positions_.data(), positions_.size(), values);
    }
    ThrowIfError(status);
    return target;
  }

 private:
  std::unique_ptr<FrameDecoder> decoder_;
  std::mutex mutex_;
  Eigen::Matrix3Xf positions_;
};

}  // namespace

void BindStreams(py::module_& module) {
  py::class_<StreamDecoder>(module, "StreamDecoder")
      .def(py::init<int, int, int, int, std::array<float, 3>, float, int, py::bytes,
                    TakenArray<int32_t>>(),
           py::arg("encoding"), py::arg("num_vertices"), py::arg("num_points"),
           py::arg("num_triangles"), py::arg("origin"), py::arg("range"), py::arg("bits"),
           py::arg("topology"), py::arg("vertex_order"))
      .def("decode", &StreamDecoder::Decode, py::arg("draco"), py::arg("difference") = false,
           py::arg("checksum") = 0, py::kw_only(), py::arg("out") = py::none());
}

}  // namespace pleat
