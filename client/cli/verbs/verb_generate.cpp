// generate performer -o DIR: makes up a sequence with known truth, for a machine without captures.
#include <memory>
#include <nlohmann/json.hpp>

#include "absl/strings/str_format.h"
#include "cli/io/animation_writer.h"
#include "cli/io/frame_rate.h"
#include "cli/io/output_path.h"
#include "cli/show/json_text.h"
#include "cli/show/progress_display.h"
#include "cli/show/report_json.h"
#include "cli/verbs/verbs.h"
#include "pleat/base/file.h"
#include "pleat/base/status.h"
#include "pleat/formats/motion_file.h"
#include "pleat/performer/performer.h"

namespace pleat {
namespace {

struct GenerateOptions {
  std::string what = "performer", output, format = "pc2", style = "dance", fps;
  PerformerOptions performer;
};

nlohmann::ordered_json TruthJson(const PerformerOptions& options, const PerformerTruth& truth) {
  nlohmann::ordered_json json;
  json["schema"] = "pleat.performer_truth/1";
  json["seed"] = options.seed;
  json["character_seed"] = options.character_seed;
  json["fps"] = truth.track.fps();
  json["joints"] = JointsJson(truth.rig.skeleton);
  json["skirt_vertices"] = nlohmann::ordered_json::array();
  for (size_t v = 0; v < truth.is_skirt.size(); ++v) {
    if (truth.is_skirt[v]) json["skirt_vertices"].push_back(v);
  }
  return json;
}

// Returns where the frames go: one file beside truth.json, or a folder of their own.
std::string FramesPath(const std::string& folder, AnimationFormat format) {
  const AnimationFormatInfo& info = InfoOf(format);
  return folder + "/performer" + (info.is_file ? "." + info.name : "");
}

absl::StatusOr<Performer> Generate(const PerformerOptions& options, const Session& session) {
  ProgressDisplay display(*session.err, ChooseProgressStyle(session), MonotonicSeconds);
  return GeneratePerformer(options, InterruptibleProgress(&display).Stage("generate", 0, 1));
}

absl::Status RunGenerate(GenerateOptions options, const Session& session) {
  options.performer.style =
      options.style == "walk" ? PerformerStyle::kWalk : PerformerStyle::kDance;
  if (!options.fps.empty()) {
    PLEAT_ASSIGN_OR_RETURN(options.performer.frame_rate, ParseFrameRate(options.fps));
  }
  PLEAT_ASSIGN_OR_RETURN(const AnimationFormat format,
                         ChooseAnimationFormat(options.format, options.output));
  PLEAT_RETURN_IF_ERROR(CheckOutputFolder(session, "-o", options.output));
  PLEAT_ASSIGN_OR_RETURN(const Performer performer, Generate(options.performer, session));

  const MeshSequence& sequence = performer.sequence;
  const std::string path = FramesPath(options.output, format);
  AnimationOptions animation;
  animation.frame_rate = sequence.frame_rate();
  animation.appearance = sequence.appearance();
  animation.name = "performer";
  std::unique_ptr<AnimationWriter> writer =
      MakeAnimationWriter(format, path, sequence.topology(), std::move(animation));
  for (int t = 0; t < sequence.num_frames(); ++t) {
    PLEAT_RETURN_IF_ERROR(writer->AddFrame(sequence.frame(t)));
  }
  PLEAT_RETURN_IF_ERROR(writer->Finish());
  const std::string truth_path = options.output + "/truth.json";
  PLEAT_RETURN_IF_ERROR(
      WriteFile(truth_path, TruthJson(options.performer, performer.truth).dump() + "\n"));

  const std::string motion_path = options.output + "/motion.json";
  PLEAT_RETURN_IF_ERROR(
      WriteMotion(motion_path, performer.truth.rig.skeleton, performer.truth.track));
  if (session.json) {
    nlohmann::ordered_json json = {{"schema", "pleat.generate/1"},
                                   {"sequence", path},
                                   {"truth", truth_path},
                                   {"motion", motion_path},
                                   {"num_frames", sequence.num_frames()},
                                   {"num_vertices", sequence.num_vertices()}};
    *session.out << JsonText(json);
  } else {
    *session.out << absl::StrFormat("%s: %d frames of %d vertices; the truth in %s and %s\n", path,
                                    sequence.num_frames(), sequence.num_vertices(), truth_path,
                                    motion_path);
  }
  return absl::OkStatus();
}

}  // namespace

void AddGenerateVerb(CLI::App& app, Session& session) {
  auto options = std::make_shared<GenerateOptions>();
  CLI::App* verb = AddVerb(app, session, "generate", "make a sequence whose truth is known",
                           [options, &session] { return RunGenerate(*options, session); });
  verb->add_option("WHAT", options->what, "performer: a closed character in a swinging skirt")
      ->required()
      ->check(CLI::IsMember({"performer"}));
  verb->add_option("-o,--output", options->output,
                   "folder for the sequence, truth.json and motion.json")
      ->required();
  verb->add_option("--format", options->format, FormatFlagHelp("drc"))->capture_default_str();
  verb->add_option("--seed", options->performer.seed, "of the motion")->capture_default_str();
  verb->add_option("--character-seed", options->performer.character_seed,
                   "of the body: the same gives the same mesh")
      ->capture_default_str();
  verb->add_option("--style", options->style, "of the motion: dance or walk")
      ->check(CLI::IsMember({"dance", "walk"}))
      ->capture_default_str();
  verb->add_option("--frames", options->performer.num_frames, "number of frames")
      ->capture_default_str();
  verb->add_option("--vertices", options->performer.num_vertices, "wanted number of vertices")
      ->capture_default_str();
  verb->add_option("--fps", options->fps, "frames per second [30]");
  verb->add_option("--height", options->performer.height_m, "body height, meters")
      ->capture_default_str();
  verb->add_option("--yaw", options->performer.yaw_degrees, "facing of frame 0 about +y from +z")
      ->capture_default_str();
  AddForceFlag(verb, session);
  AddInProcessFlag(verb, session);
}

}  // namespace pleat
