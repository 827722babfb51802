// decompress x.plt -o OUT: writes the frames of a compressed sequence, or a range of them.
#include <charconv>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "absl/strings/str_format.h"
#include "cli/exit_code.h"
#include "cli/io/animation_writer.h"
#include "cli/io/output_path.h"
#include "cli/service.h"
#include "cli/show/json_text.h"
#include "cli/show/progress_display.h"
#include "cli/verbs/verbs.h"
#include "pleat/base/file.h"
#include "pleat/base/status.h"
#include "pleat/service/compression.h"

namespace pleat {
namespace {

struct DecompressVerbOptions {
  std::string input, output, format = "auto", frames;
};

// Turns "a:b" into [a, b), where either end may be missing, and "" into all frames.
absl::StatusOr<FrameRange> ParseRange(const std::string& text) {
  if (text.empty()) return FrameRange{};
  const size_t colon = text.find(':');
  const auto parse = [&text](size_t begin, size_t end, int* value) {
    if (begin == end) return true;
    const auto [last, error] = std::from_chars(text.data() + begin, text.data() + end, *value);
    return error == std::errc() && last == text.data() + end;
  };
  FrameRange range;
  if (colon == std::string::npos || !parse(0, colon, &range.begin) ||
      !parse(colon + 1, text.size(), &range.end)) {
    return UsageError("--frames is '" + text + "'; write a:b for the frames a to b - 1");
  }
  const bool has_end = colon + 1 < text.size();
  if (range.begin < 0 || (has_end && range.end <= range.begin)) {
    return absl::InvalidArgumentError("--frames is '" + text + "', which holds no frame");
  }
  return range;
}

// Writes frames as they come. The writer is made when the shape is known, which comes first.
class Output {
 public:
  Output(const DecompressVerbOptions& flags, AnimationFormat format, Progress progress)
      : flags_(flags), format_(format), progress_(std::move(progress)) {}

  // num_frames: the length of the range.
  DecodedFramesSink Sink(int num_frames) {
    return {.on_shape =
                [this](const MeshSequence& shape) {
                  AnimationOptions options;
                  options.frame_rate = shape.frame_rate();
                  options.appearance = shape.appearance();
                  options.name = shape.name();
                  writer_ = MakeAnimationWriter(format_, flags_.output, shape.topology(),
                                                std::move(options));
                  num_vertices_ = shape.num_vertices();
                  return absl::OkStatus();
                },
            .on_frame = [this, num_frames](int, const Eigen::Matrix3Xf& positions) -> absl::Status {
              PLEAT_RETURN_IF_ERROR(writer_->AddFrame(positions));
              return progress_.Report(1.0 * ++num_frames_ / num_frames);
            }};
  }
  absl::Status Finish() { return writer_->Finish(); }
  int num_frames() const { return num_frames_; }
  int num_vertices() const { return num_vertices_; }

 private:
  const DecompressVerbOptions& flags_;
  const AnimationFormat format_;
  const Progress progress_;
  std::unique_ptr<AnimationWriter> writer_;
  int num_frames_ = 0, num_vertices_ = 0;
};

int NumFrames(FrameRange range, int of_sequence) {
  return (range.end == 0 ? of_sequence : range.end) - range.begin;
}

absl::Status DecodeHere(const std::string& input, FrameRange range, Output* output) {
  PLEAT_ASSIGN_OR_RETURN(std::string bytes, ReadFile(input));
  absl::StatusOr<SequenceDecoder> decoder = SequenceDecoder::Open(std::move(bytes));
  if (!decoder.ok()) {
    return absl::Status(decoder.status().code(),
                        input + ": " + std::string(decoder.status().message()));
  }
  const int num_frames = decoder->num_frames();
  PLEAT_ASSIGN_OR_RETURN(const std::unique_ptr<DecodeSession> decode,
                         MakeDecodeSession(*std::move(decoder), range));
  return DecodeInto(*decode, range, output->Sink(NumFrames(range, num_frames)));
}

// Decodes on a service. input: a file, which is uploaded first, or the id of a stored sequence.
absl::Status DecodeOnService(const std::string& input, FrameRange range, const Session& session,
                             Output* output) {
  PLEAT_ASSIGN_OR_RETURN(const std::unique_ptr<CharacterService> service, OpenService(session));
  std::error_code error;
  CompressedSequenceInfo info;
  if (std::filesystem::is_regular_file(input, error)) {
    PLEAT_ASSIGN_OR_RETURN(const std::string bytes, ReadFile(input));
    ProgressDisplay display(*session.err, ChooseProgressStyle(session), MonotonicSeconds);
    PLEAT_ASSIGN_OR_RETURN(info, service->compressed_sequences().Upload(
                                     bytes, InterruptibleProgress(&display).Stage("upload", 0, 1)));
  } else {
    PLEAT_ASSIGN_OR_RETURN(const auto infos, service->compressed_sequences().List());
    PLEAT_ASSIGN_OR_RETURN(const std::string id, CompleteId(infos, input, "compressed sequence"));
    PLEAT_ASSIGN_OR_RETURN(info, service->compressed_sequences().Get(id));
  }
  return DecodeFrames(service->compressed_sequences(), info.id, range,
                      output->Sink(NumFrames(range, info.num_frames)));
}

absl::Status RunDecompress(const DecompressVerbOptions& flags, const Session& session) {
  PLEAT_ASSIGN_OR_RETURN(const AnimationFormat format,
                         ChooseAnimationFormat(flags.format, flags.output, AnimationFormat::kObj));
  PLEAT_RETURN_IF_ERROR(CheckAnimationOutput(session, flags.output, format, flags.format));
  PLEAT_ASSIGN_OR_RETURN(const FrameRange range, ParseRange(flags.frames));
  const double start_seconds = MonotonicSeconds();
  ProgressDisplay display(*session.err, ChooseProgressStyle(session), MonotonicSeconds);
  Output output(flags, format, InterruptibleProgress(&display).Stage("decompress", 0, 1));
  PLEAT_RETURN_IF_ERROR(RunsOnService(session)
                            ? DecodeOnService(flags.input, range, session, &output)
                            : DecodeHere(flags.input, range, &output));
  PLEAT_RETURN_IF_ERROR(output.Finish());
  display.Finish();
  const double seconds = MonotonicSeconds() - start_seconds;
  if (session.json) {
    const nlohmann::ordered_json json = {{"schema", "pleat.decompress/1"},
                                         {"output", flags.output},
                                         {"first_frame", range.begin},
                                         {"num_frames", output.num_frames()},
                                         {"num_vertices", output.num_vertices()},
                                         {"seconds", seconds}};
    *session.out << JsonText(json);
  } else {
    *session.out << absl::StrFormat("%s: %d frames of %d vertices in %.2f s\n", flags.output,
                                    output.num_frames(), output.num_vertices(), seconds);
  }
  return absl::OkStatus();
}

}  // namespace

void AddDecompressVerb(CLI::App& app, Session& session) {
  auto options = std::make_shared<DecompressVerbOptions>();
  CLI::App* verb = AddVerb(app, session, "decompress", "the frames of a compressed animation",
                           [options, &session] { return RunDecompress(*options, session); });
  verb->add_option("INPUT", options->input,
                   "a compressed sequence (.plt), or its id on the service")
      ->required();
  verb->add_option("-o,--output", options->output, "OUT.ENDING (see --format) or a folder")
      ->required();
  verb->add_option("--frames", options->frames, "A:B: only the frames A to B - 1 (default: all)");
  verb->add_option("--format", options->format, FormatFlagHelp("obj"))->capture_default_str();
  AddForceFlag(verb, session);
  AddOptionalServerFlags(verb, session);
}

}  // namespace pleat
