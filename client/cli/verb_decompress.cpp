// decompress x.plt -o OUT: the frames of a compressed sequence, or a range of them.
#include <charconv>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "absl/strings/str_format.h"
#include "cli/animation_writer.h"
#include "cli/exit_code.h"
#include "cli/progress_display.h"
#include "cli/verbs.h"
#include "pleat/base/file.h"
#include "pleat/base/status.h"
#include "pleat/codec/sequence_decoder.h"

namespace pleat {
namespace {

struct DecompressVerbOptions {
  std::string input, output, format = "auto", frames;
};

// "a:b" -> [a, b), either end may be missing; "" -> all.
absl::StatusOr<std::pair<int, int>> ParseRange(const std::string& text, int num_frames) {
  if (text.empty()) return std::pair(0, num_frames);
  const size_t colon = text.find(':');
  const auto parse = [&text](size_t begin, size_t end, int missing, int* value) {
    *value = missing;
    if (begin == end) return true;
    const auto [last, error] = std::from_chars(text.data() + begin, text.data() + end, *value);
    return error == std::errc() && last == text.data() + end;
  };
  int begin = 0, end = 0;
  if (colon == std::string::npos || !parse(0, colon, 0, &begin) ||
      !parse(colon + 1, text.size(), num_frames, &end)) {
    return UsageError("--frames is '" + text + "'; write a:b for the frames a to b - 1");
  }
  return std::pair(begin, end);
}

absl::Status RunDecompress(const DecompressVerbOptions& flags, const Session& session) {
  PLEAT_ASSIGN_OR_RETURN(const AnimationFormat format,
                         ChooseAnimationFormat(flags.format, flags.output, AnimationFormat::kObj));
  const double start_seconds = MonotonicSeconds();
  PLEAT_ASSIGN_OR_RETURN(std::string bytes, ReadFile(flags.input));
  absl::StatusOr<SequenceDecoder> decoder = SequenceDecoder::Open(std::move(bytes));
  if (!decoder.ok()) {
    return absl::Status(decoder.status().code(),
                        flags.input + ": " + std::string(decoder.status().message()));
  }
  PLEAT_ASSIGN_OR_RETURN(const auto range, ParseRange(flags.frames, decoder->num_frames()));
  AnimationOptions options;
  options.frame_rate = decoder->frame_rate();
  options.appearance = decoder->appearance();
  options.name = decoder->name();
  const std::unique_ptr<AnimationWriter> writer =
      MakeAnimationWriter(format, flags.output, decoder->topology(), std::move(options));
  ProgressDisplay display(*session.err, ChooseProgressStyle(session), MonotonicSeconds);
  PLEAT_RETURN_IF_ERROR(decoder->Decode(
      range.first, range.second,
      [&writer](int, const Eigen::Matrix3Xf& positions) { return writer->AddFrame(positions); },
      InterruptibleProgress(&display).Stage("decompress", 0, 1)));
  PLEAT_RETURN_IF_ERROR(writer->Finish());
  display.Finish();
  const int num_frames = range.second - range.first;
  const double seconds = MonotonicSeconds() - start_seconds;
  if (session.json) {
    const nlohmann::ordered_json json = {{"schema", "pleat.decompress/1"},
                                         {"output", flags.output},
                                         {"first_frame", range.first},
                                         {"num_frames", num_frames},
                                         {"num_vertices", decoder->num_vertices()},
                                         {"seconds", seconds}};
    *session.out << json.dump(2) << "\n";
  } else if (!session.quiet) {
    *session.out << absl::StrFormat("%s: %d frames of %d vertices in %.2f s\n", flags.output,
                                    num_frames, decoder->num_vertices(), seconds);
  }
  return absl::OkStatus();
}

}  // namespace

void AddDecompressVerb(CLI::App& app, Session& session) {
  auto options = std::make_shared<DecompressVerbOptions>();
  CLI::App* verb = AddVerb(app, session, "decompress", "the frames of a compressed animation",
                           [options, &session] { return RunDecompress(*options, session); });
  verb->add_option("INPUT", options->input, "a compressed sequence (.plt)")->required();
  verb->add_option("-o,--output", options->output, "OUT.pc2, OUT.pseq or a folder")->required();
  verb->add_option("--frames", options->frames, "A:B: only the frames A to B - 1 (default: all)");
  verb->add_option("--format", options->format,
                   "auto (by the ending of OUT; a folder gets obj), pc2, pseq, obj, ply or drc")
      ->capture_default_str();
  AddInProcessFlag(verb, session);
}

}  // namespace pleat
