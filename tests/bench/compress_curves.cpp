// compress_curves OUT_FOLDER INPUT...: rate-distortion curves of the sequence codec and of PCA with
// Draco, as a table on stdout and one PNG per input (base-10 logarithm of bits per vertex and
// frame).
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "bench/pca_draco.h"
#include "pleat/base/file.h"
#include "pleat/formats/sequence_reader.h"
#include "pleat/render/line_plot.h"
#include "pleat/sequence_codec/compress_sequence.h"
#include "pleat/sequence_codec/sequence_decoder.h"

namespace pleat {
namespace {

constexpr double kKgPercents[] = {5, 2, 1, 0.5, 0.2, 0.1};

double Seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double DecodeSeconds(const std::string& bytes) {
  const double start = Seconds();
  SequenceDecoder decoder = SequenceDecoder::Open(bytes).value();
  decoder
      .Decode(0, decoder.num_frames(),
              [](int, const Eigen::Matrix3Xf&) { return absl::OkStatus(); })
      .IgnoreError();
  return Seconds() - start;
}

absl::Status Measure(const std::string& input, const std::string& out_folder) {
  const auto sequence = ReadSequence(input);
  if (!sequence.ok()) return sequence.status();
  const std::string name = std::filesystem::path(input).stem().string();
  const double num_values = static_cast<double>(sequence->num_vertices()) * sequence->num_frames();
  std::printf("\n%s: %d frames, %d vertices; bits per vertex and frame\n", name.c_str(),
              sequence->num_frames(), sequence->num_vertices());
  std::printf(
      "| KG %% | PCA + Draco | .plt, whole file | any face order | without topology | saved %% | "
      "largest error mm"
      " | encode s | decode frames/s |\n|---|---|---|---|---|---|---|---|---|\n");
  PlotSeries baseline{"PCA + Draco, without order of vertices and faces", {}};
  PlotSeries whole{".plt, whole file", {}}, motion{".plt without topology", {}};
  for (const double kg_percent : kKgPercents) {
    const PcaDracoResult pca = CompressWithPcaDraco(*sequence, kg_percent);
    const double pca_bpvf = 8.0 * static_cast<double>(pca.num_bytes) / num_values;
    CompressOptions options;
    options.goal = CompressionGoal::kKg;
    options.kg_percent = kg_percent;
    CompressSummary summary;
    const double start = Seconds();
    const auto bytes = CompressSequence(*sequence, options, &summary);
    const double encode_seconds = Seconds() - start;
    if (!bytes.ok()) return bytes.status();
    options.keep_face_order = false;
    CompressSummary any_order;
    const auto reordered = CompressSequence(*sequence, options, &any_order);
    if (!reordered.ok()) return reordered.status();
    std::printf("| %g | %.3f | %.3f | %.3f | %.3f | %.0f | %.2f | %.1f | %.0f |\n", kg_percent,
                pca_bpvf, summary.bpvf, any_order.bpvf, summary.bpvf_without_topology,
                100 * (1 - summary.bpvf / pca_bpvf), summary.max_error_mm, encode_seconds,
                sequence->num_frames() / DecodeSeconds(*bytes));
    baseline.values.push_back(std::log10(pca_bpvf));
    whole.values.push_back(std::log10(summary.bpvf));
    motion.values.push_back(std::log10(summary.bpvf_without_topology));
  }
  LinePlotOptions options;
  options.title = name;
  options.x_label = "0 .. 5: KG error of 5, 2, 1, .5, .2, .1 %";
  options.y_label = "log10 of bits per vertex and frame";
  options.y_from_zero = false;
  const auto plot = RenderLinePlot({baseline, whole, motion}, options);
  if (!plot.ok()) return plot.status();
  return WriteFile(out_folder + "/compress_" + name + ".png", EncodePng(*plot));
}

}  // namespace
}  // namespace pleat

int main(int argc, char** argv) {
  for (int i = 2; i < argc; ++i) {
    const absl::Status status = pleat::Measure(argv[i], argv[1]);
    if (!status.ok()) {
      std::fprintf(stderr, "%s: %s\n", argv[i], std::string(status.message()).c_str());
      return 1;
    }
  }
  return argc < 3 ? 2 : 0;
}
