#include <string>

#include "bindings.h"
#include "pleat/sequence_codec/compress_sequence.h"
#include "pleat/sequence_codec/sequence_decoder.h"
#include "python_error.h"

namespace py = pybind11;

namespace pleat {
namespace {

// The bytes, and what was measured on them.
py::tuple Compress(const MeshSequence& sequence, const py::object& max_error_mm,
                   const py::object& kg_percent, const py::object& grid_bits, int num_threads,
                   const py::object& progress) {
  if (max_error_mm.is_none() + kg_percent.is_none() + grid_bits.is_none() != 2) {
    throw StatusException(absl::InvalidArgumentError(
        "give one of max_error_mm, kg_percent and grid_bits, which is what the file promises"));
  }
  CompressOptions options{.num_threads = num_threads};
  if (!max_error_mm.is_none()) options.max_error_mm = py::cast<double>(max_error_mm);
  if (!kg_percent.is_none()) {
    options.goal = CompressionGoal::kKg;
    options.kg_percent = py::cast<double>(kg_percent);
  }
  if (!grid_bits.is_none()) {
    options.goal = CompressionGoal::kGrid;
    options.grid_bits = py::cast<int>(grid_bits);
  }
  PythonProgress report(progress);
  CompressSummary summary;
  absl::StatusOr<std::string> bytes;
  {
    const py::gil_scoped_release unlock;
    bytes = CompressSequence(sequence, options, &summary, report.token());
  }
  report.Check();
  const std::string file = ValueOrThrow(std::move(bytes));
  return py::make_tuple(py::bytes(file),
                        py::dict(py::arg("bits_per_vertex_per_frame") = summary.bpvf,
                                 py::arg("kg_percent") = summary.kg_percent,
                                 py::arg("max_error_mm") = summary.max_error_mm));
}

MeshSequence Decompress(const std::string& bytes, const py::object& progress) {
  PythonProgress report(progress);
  absl::StatusOr<MeshSequence> sequence;
  {
    const py::gil_scoped_release unlock;
    absl::StatusOr<SequenceDecoder> decoder = SequenceDecoder::Open(bytes);
    if (decoder.ok()) {
      sequence = decoder->DecodeAll(report.token());
    } else {
      sequence = decoder.status();
    }
  }
  report.Check();
  return ValueOrThrow(std::move(sequence));
}

}  // namespace

void BindCodec(py::module_& module) {
  module.def("compress", &Compress, py::arg("sequence"), py::arg("max_error_mm"),
             py::arg("kg_percent"), py::arg("grid_bits"), py::arg("num_threads"),
             py::arg("progress"));
  module.def("decompress", &Decompress, py::arg("data"), py::arg("progress"));
}

}  // namespace pleat
