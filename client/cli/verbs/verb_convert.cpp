// convert INPUT -o OUT: an animation from one file format to another.
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "cli/exit_code.h"
#include "cli/io/animation_writer.h"
#include "cli/io/frame_rate.h"
#include "cli/io/input.h"
#include "cli/io/not_kept.h"
#include "cli/io/output_path.h"
#include "cli/io/space.h"
#include "cli/show/input_notes_json.h"
#include "cli/show/json_text.h"
#include "cli/show/progress_display.h"
#include "cli/verbs/verbs.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

struct ConvertOptions {
  std::string input, output, format = "auto", fps, from_unit, from_up, unit, up, package;
  std::optional<double> start_frame;
  std::vector<std::string> out_keys;
};

// What the result is, and what was said about it.
struct Conversion {
  AnimationFormat format;
  Space from, to;
  double first_frame = 0;
  std::vector<InputNote> notes;
  std::vector<std::string> not_kept;
};

InputNote Said(NoteSeverity severity, const char* kind, std::string text) {
  return {.severity = severity, .kind = kind, .text = std::move(text)};
}

bool IsGltfInput(const std::string& input) {
  const std::string ending = std::filesystem::path(input).extension().string();
  return ending == ".glb" || ending == ".gltf";
}

absl::Status SetSpace(const std::string& flag_unit, const std::string& unit,
                      const std::string& flag_up, const std::string& up, Space* space) {
  if (!unit.empty()) {
    PLEAT_ASSIGN_OR_RETURN(space->unit_m, ParseUnit(flag_unit, unit));
  }
  if (!up.empty()) {
    PLEAT_ASSIGN_OR_RETURN(space->up, ParseUp(flag_up, up));
  }
  return absl::OkStatus();
}

// Decides about units and axes, and says what is taken for granted.
absl::Status ChooseSpaces(const ConvertOptions& options, Conversion* conversion) {
  PLEAT_RETURN_IF_ERROR(
      SetSpace("--from-unit", options.from_unit, "--from-up", options.from_up, &conversion->from));
  conversion->to = conversion->from;
  const bool is_glb = conversion->format == AnimationFormat::kGlb;
  if (!options.package.empty()) {
    PLEAT_ASSIGN_OR_RETURN(const PackagePreset preset, FindPackage(options.package));
    conversion->to = preset.space;
    const AnimationFormatInfo& info = InfoOf(conversion->format);
    const std::string ending = info.is_file ? "." + info.name : info.name;
    if (std::ranges::count(preset.endings, ending) == 0) {
      conversion->notes.push_back(
          Said(NoteSeverity::kWarning, "format_not_for_package",
               absl::StrCat(preset.name, " does not read ", ending, " by itself; it reads ",
                            absl::StrJoin(preset.endings, ", "))));
    }
  }
  if (is_glb) conversion->to = {};
  PLEAT_RETURN_IF_ERROR(SetSpace("--unit", options.unit, "--up", options.up, &conversion->to));
  if (is_glb && conversion->to != Space{}) {
    return UsageError("glTF is in meters with Y up: leave --unit and --up away");
  }
  const bool is_asked = !options.package.empty() || !options.unit.empty() || !options.up.empty();
  const bool is_said =
      (!options.from_unit.empty() && !options.from_up.empty()) || IsGltfInput(options.input);
  if ((is_asked || SaysSpace(conversion->format)) && !is_said) {
    conversion->notes.push_back(
        Said(NoteSeverity::kNote, "space_assumed",
             absl::StrCat("'", options.input, "' is taken as ", DescribeSpace(conversion->from),
                          ": it does not say; --from-unit and --from-up do")));
  }
  return absl::OkStatus();
}

void SayRate(const ConvertOptions& options, const InputReport& report, const MeshSequence& sequence,
             Conversion* conversion) {
  const bool is_warned = std::ranges::any_of(report.notes, [](const InputNote& note) {
    return note.kind == "frame_rate_assumed" || note.kind == "times_invalid";
  });
  if (report.has_frame_rate || is_warned || !options.fps.empty() || sequence.num_frames() < 2 ||
      !SaysFrameRate(conversion->format)) {
    return;
  }
  conversion->notes.push_back(
      Said(NoteSeverity::kNote, "frame_rate_assumed",
           absl::StrCat("'", options.input,
                        "' has no frame rate: ", FormatFrameRate(sequence.frame_rate()),
                        " frames per second are taken; --fps says another rate")));
}

absl::Status Write(const ConvertOptions& options, const MeshSequence& sequence,
                   const Conversion& conversion, const Session& session) {
  AnimationOptions animation;
  animation.frame_rate = sequence.frame_rate();
  animation.appearance = sequence.appearance();
  animation.name = sequence.name();
  animation.first_frame = conversion.first_frame;
  animation.space = conversion.to;
  for (const std::string& key : options.out_keys) {
    if (absl::Status status = SetNpzKey(key, &animation.npz_keys); !status.ok()) {
      return UsageError(absl::StrCat("--out-key: ", status.message()));
    }
  }
  ProgressDisplay display(*session.err, ChooseProgressStyle(session), MonotonicSeconds);
  const Progress progress = InterruptibleProgress(&display).Stage("write", 0, 1);
  const std::unique_ptr<AnimationWriter> writer = MakeAnimationWriter(
      conversion.format, options.output, sequence.topology(), std::move(animation));
  for (int t = 0; t < sequence.num_frames(); ++t) {
    PLEAT_RETURN_IF_ERROR(writer->AddFrame(sequence.frame(t)));
    PLEAT_RETURN_IF_ERROR(progress.Report((t + 1.) / (sequence.num_frames() + 1)));
  }
  PLEAT_RETURN_IF_ERROR(writer->Finish());
  display.Finish();
  return absl::OkStatus();
}

void Print(const ConvertOptions& options, const MeshSequence& sequence,
           const Conversion& conversion, const Session& session) {
  if (session.json) {
    const nlohmann::ordered_json json = {{"schema", "pleat.convert/1"},
                                         {"output", options.output},
                                         {"format", InfoOf(conversion.format).name},
                                         {"num_frames", sequence.num_frames()},
                                         {"num_vertices", sequence.num_vertices()},
                                         {"frame_rate", FormatFrameRate(sequence.frame_rate())},
                                         {"first_frame", conversion.first_frame},
                                         {"unit_m", conversion.to.unit_m},
                                         {"up", conversion.to.up == UpAxis::kY ? "y" : "z"},
                                         {"not_kept", conversion.not_kept},
                                         {"input_notes", InputNotesJson(conversion.notes)}};
    *session.out << JsonText(json);
    return;
  }
  *session.out << absl::StrFormat("%s: %d frames of %d vertices, %s per second from frame %g%s\n",
                                  options.output, sequence.num_frames(), sequence.num_vertices(),
                                  FormatFrameRate(sequence.frame_rate()), conversion.first_frame,
                                  SaysSpace(conversion.format) || conversion.to != conversion.from
                                      ? absl::StrCat(", ", DescribeSpace(conversion.to))
                                      : "");
}

absl::Status RunConvert(const ConvertOptions& options, const Session& session) {
  Conversion conversion;
  PLEAT_ASSIGN_OR_RETURN(conversion.format, ChooseAnimationFormat(options.format, options.output,
                                                                  AnimationFormat::kObj));
  PLEAT_RETURN_IF_ERROR(
      CheckAnimationOutput(session, options.output, conversion.format, options.format));
  std::vector<InputNote> notes;
  PLEAT_RETURN_IF_ERROR(ChooseSpaces(options, &conversion));
  InputReport report;
  PLEAT_ASSIGN_OR_RETURN(const MeshSequence input,
                         ReadInput(session, options.input, options.fps, &notes, &report));
  SayRate(options, report, input, &conversion);
  PLEAT_ASSIGN_OR_RETURN(const MeshSequence sequence,
                         InSpace(input, conversion.from, conversion.to));
  conversion.first_frame = options.start_frame.value_or(report.first_frame.value_or(0));
  conversion.not_kept = NotKept(conversion.format, sequence, conversion.first_frame);
  if (!conversion.not_kept.empty()) {
    conversion.notes.push_back(Said(NoteSeverity::kNote, "not_kept",
                                    absl::StrCat("not kept in '", options.output,
                                                 "': ", absl::StrJoin(conversion.not_kept, ", "))));
  }
  SayNotes(session, conversion.notes, &notes);
  const auto num_warnings =
      std::ranges::count(conversion.notes, NoteSeverity::kWarning, &InputNote::severity);
  conversion.notes = std::move(notes);
  PLEAT_RETURN_IF_ERROR(Write(options, sequence, conversion, session));
  Print(options, sequence, conversion, session);
  return RefuseWarningsWhenStrict(session, static_cast<size_t>(num_warnings));
}

}  // namespace

void AddConvertVerb(CLI::App& app, Session& session) {
  auto options = std::make_shared<ConvertOptions>();
  CLI::App* verb = AddVerb(app, session, "convert", "write an animation in another file format",
                           [options, &session] { return RunConvert(*options, session); });
  verb->add_option("INPUT", options->input, "any animation that pleat reads")->required();
  verb->add_option("-o,--output", options->output, "OUT.ENDING (see --format) or a folder")
      ->required();
  verb->add_option("--format", options->format, FormatFlagHelp("obj"))->capture_default_str();
  verb->add_option("--fps", options->fps,
                   "frames per second (30, 29.97, 30000/1001), in place of what INPUT says");
  verb->add_option("--start-frame", options->start_frame,
                   "number of the first frame [what INPUT says, else 0]");
  verb->add_option("--from-unit", options->from_unit,
                   "what INPUT is in: m, cm, mm, km, in, ft, yd or meters per unit [m]");
  verb->add_option("--from-up", options->from_up, "the axis of INPUT that points up: y or z [y]");
  verb->add_option("--unit", options->unit, "what OUT shall be in [as INPUT]");
  verb->add_option("--up", options->up, "the axis of OUT that shall point up [as INPUT]");
  verb->add_option("--for", options->package,
                   "the unit and axis that a package expects: blender, maya, houdini, unreal, "
                   "unity or godot");
  verb->add_option("--out-key", options->out_keys,
                   "ROLE=NAME: an array of OUT.npz (positions, faces, face_sizes, frame_rate)");
  AddObjectFlag(verb, session);
  AddForceFlag(verb, session);
  AddInProcessFlag(verb, session);
}

}  // namespace pleat
