// compress INPUT -o x.plt: a mesh sequence as a small file with a promised error.
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "absl/strings/str_format.h"
#include "cli/exit_code.h"
#include "cli/input.h"
#include "cli/progress_display.h"
#include "cli/text_table.h"
#include "cli/verbs.h"
#include "pleat/base/file.h"
#include "pleat/base/status.h"
#include "pleat/codec/compress_sequence.h"
#include "pleat/codec/sequence_decoder.h"

namespace pleat {
namespace {

struct CompressVerbOptions {
  std::string input, output, report, fps;
  double max_error_mm = 0, kg_percent = 0;  // 0: not given
  int grid_bits = 0;
  int num_threads = 0;
  bool any_face_order = false;
};

absl::StatusOr<CompressOptions> ChooseGoal(const CompressVerbOptions& flags) {
  CompressOptions options;
  options.num_threads = flags.num_threads;
  options.keep_face_order = !flags.any_face_order;
  const int given = (flags.max_error_mm != 0) + (flags.kg_percent != 0) + (flags.grid_bits != 0);
  if (given != 1) {
    return UsageError("say one of --max-error-mm E, --kg PERCENT and --lossless-at-bits B");
  }
  if (flags.max_error_mm != 0) {
    options.goal = CompressionGoal::kMaxError;
    options.max_error_mm = flags.max_error_mm;
  } else if (flags.kg_percent != 0) {
    options.goal = CompressionGoal::kKg;
    options.kg_percent = flags.kg_percent;
  } else {
    options.goal = CompressionGoal::kGrid;
    options.grid_bits = flags.grid_bits;
  }
  return options;
}

// Seconds to open the bytes and decode all frames, on this thread.
absl::StatusOr<double> TimeDecoding(const std::string& bytes) {
  const double start_seconds = MonotonicSeconds();
  PLEAT_ASSIGN_OR_RETURN(SequenceDecoder decoder, SequenceDecoder::Open(bytes));
  PLEAT_RETURN_IF_ERROR(decoder.Decode(
      0, decoder.num_frames(), [](int, const Eigen::Matrix3Xf&) { return absl::OkStatus(); }));
  return MonotonicSeconds() - start_seconds;
}

nlohmann::ordered_json ReportJson(const MeshSequence& sequence, const CompressSummary& summary,
                                  double encode_seconds, double decode_seconds) {
  return {{"schema", "pleat.compress/1"},
          {"bytes", summary.num_bytes},
          {"bpvf", summary.bpvf},
          {"kg_percent", summary.kg_percent},
          {"max_error_mm", summary.max_error_mm},
          {"encode_seconds", encode_seconds},
          {"decode_seconds", decode_seconds},
          {"topology_bytes", summary.num_topology_bytes},
          {"bpvf_without_topology", summary.bpvf_without_topology},
          {"num_frames", sequence.num_frames()},
          {"num_vertices", sequence.num_vertices()}};
}

absl::Status RunCompress(const CompressVerbOptions& flags, const Session& session) {
  PLEAT_ASSIGN_OR_RETURN(const CompressOptions options, ChooseGoal(flags));
  PLEAT_ASSIGN_OR_RETURN(const MeshSequence sequence, ReadInput(session, flags.input, flags.fps));
  ProgressDisplay display(*session.err, ChooseProgressStyle(session), MonotonicSeconds);
  const double start_seconds = MonotonicSeconds();
  CompressSummary summary;
  PLEAT_ASSIGN_OR_RETURN(
      const std::string bytes,
      CompressSequence(sequence, options, &summary, InterruptibleProgress(&display)));
  const double encode_seconds = MonotonicSeconds() - start_seconds;
  display.Finish();
  PLEAT_RETURN_IF_ERROR(WriteFile(flags.output, bytes));
  PLEAT_ASSIGN_OR_RETURN(const double decode_seconds, TimeDecoding(bytes));
  const nlohmann::ordered_json json = ReportJson(sequence, summary, encode_seconds, decode_seconds);
  if (!flags.report.empty()) {
    PLEAT_RETURN_IF_ERROR(WriteFile(flags.report, json.dump(2) + "\n"));
  }
  if (session.json) {
    *session.out << json.dump(2) << "\n";
  } else if (!session.quiet) {
    const double raw_bytes = 12.0 * sequence.num_vertices() * sequence.num_frames();
    *session.out << absl::StrFormat(
        "%s: %s, 1/%.0f of its positions as float32; %.3f bits per vertex and frame\n"
        "error: KG %.4g %%, largest %.4g mm; encoded in %.1f s, decodes at %.0f frames/s\n",
        flags.output, FormatBytes(static_cast<double>(summary.num_bytes)),
        raw_bytes / static_cast<double>(summary.num_bytes), summary.bpvf, summary.kg_percent,
        summary.max_error_mm, encode_seconds, sequence.num_frames() / decode_seconds);
  }
  return absl::OkStatus();
}

}  // namespace

void AddCompressVerb(CLI::App& app, Session& session) {
  auto options = std::make_shared<CompressVerbOptions>();
  CLI::App* verb =
      AddVerb(app, session, "compress", "make an animation small, with a promised error",
              [options, &session] { return RunCompress(*options, session); });
  verb->add_option("INPUT", options->input, "folder, glob, .pc2 or .pseq")->required();
  verb->add_option("-o,--output", options->output, "the compressed sequence, OUT.plt")->required();
  verb->add_option("--max-error-mm", options->max_error_mm,
                   "no vertex of any frame is further off than this, mm")
      ->check(CLI::Range(1e-3, 1e6));
  verb->add_option("--kg", options->kg_percent,
                   "the error of all positions is at most PERCENT of their spread about each "
                   "frame's centroid (Karni and Gotsman)")
      ->check(CLI::Range(1e-4, 50.0));
  verb->add_option(
          "--lossless-at-bits", options->grid_bits,
          "positions are exact on a grid of 2^B points along the longest side of the bounds")
      ->check(CLI::Range(8, 20));
  verb->add_flag("--any-face-order", options->any_face_order,
                 "faces may change their order (vertices never do): about 1.5 bytes less per face");
  verb->add_option("--report", options->report, "JSON report (pleat.compress/1)");
  verb->add_option("--fps", options->fps, "frames per second, where the input does not say");
  verb->add_option("--threads", options->num_threads, "0 = one per core")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  AddInProcessFlag(verb, session);
}

}  // namespace pleat
