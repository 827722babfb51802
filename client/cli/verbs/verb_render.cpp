// render INPUT... -o sheet.png: draws a contact sheet with one row per input; with --rig it draws
// skeletons, with --compare heat maps of the errors of a model.
#include <memory>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "cli/exit_code.h"
#include "cli/io/input.h"
#include "cli/io/model_input.h"
#include "cli/io/output_path.h"
#include "cli/show/error_sheet.h"
#include "cli/show/input_notes_json.h"
#include "cli/show/json_text.h"
#include "cli/show/progress_display.h"
#include "cli/show/rig_sheet.h"
#include "cli/show/sheet.h"
#include "cli/verbs/verbs.h"
#include "pleat/base/file.h"
#include "pleat/base/status.h"
#include "pleat/character/pose_evaluator.h"
#include "pleat/fitting/pose_fit.h"
#include "pleat/rigging/auto_rig.h"
#include "pleat/skeleton/pose_history.h"

namespace pleat {
namespace {

struct RenderVerbOptions {
  std::vector<std::string> inputs, labels;
  std::string output, frames, model, fps;
  std::optional<double> azimuth_degrees;
  std::optional<int> count;
  SheetOptions sheet;
  double scale_mm = ErrorSheetOptions().scale_mm;
  bool rig = false, compare = false;
};

// Two animations of a model in the poses that were fitted to an input.
struct ModelAnimations {
  MeshSequence skinned, hybrid;
};

// Returns what the model's rig alone makes of the input's poses, and what rig and learned detail
// make of them, in the given frames.
absl::StatusOr<ModelAnimations> AnimateModel(std::shared_ptr<const CharacterModel> model,
                                             const MeshSequence& input,
                                             const std::vector<int>& frames,
                                             const Session& session) {
  PLEAT_ASSIGN_OR_RETURN(const PoseTrack track, FitMotionWithProgress(*model, input, session));
  std::vector<Eigen::Matrix3Xf> skinned(frames.size()), hybrid(frames.size());
  PoseEvaluator evaluator(model);
  PoseHistory history(track, model->frame_rate().fps(), model->options().history);
  std::vector<const Pose*> poses;
  EvaluatedFrame frame;
  for (size_t i = 0; i < frames.size(); ++i) {
    history.At(frames[i], &poses);
    PLEAT_RETURN_IF_ERROR(evaluator.EvaluateSkinned(*poses[0], {}, &frame));
    skinned[i] = frame.positions;
    PLEAT_RETURN_IF_ERROR(evaluator.Evaluate(poses, {}, &frame));
    hybrid[i] = frame.positions;
  }
  PLEAT_ASSIGN_OR_RETURN(MeshSequence skinned_sequence,
                         MeshSequence::Create(input.topology(), std::move(skinned)));
  PLEAT_ASSIGN_OR_RETURN(MeshSequence hybrid_sequence,
                         MeshSequence::Create(input.topology(), std::move(hybrid)));
  return ModelAnimations{std::move(skinned_sequence), std::move(hybrid_sequence)};
}

// kInvalidArgument names the first of `frames` that the sequence does not have.
absl::Status CheckFrames(const std::string& label, const MeshSequence& sequence,
                         const std::vector<int>& frames) {
  for (const int t : frames) {
    if (t < sequence.num_frames()) continue;
    return absl::InvalidArgumentError(absl::StrCat("'", label, "' has no frame ", t, ": it has ",
                                                   sequence.num_frames(), " frames, from 0"));
  }
  return absl::OkStatus();
}

// Draws the sheet of --compare: skinned only and hybrid, colored by their distance from the input,
// and the input itself.
absl::StatusOr<std::string> DrawComparison(const RenderVerbOptions& options, const Session& session,
                                           std::vector<InputNote>* notes) {
  if (options.inputs.size() != 2 || options.rig || !options.model.empty() ||
      !options.labels.empty()) {
    return UsageError(
        "--compare takes two inputs, a sequence and a model, and none of --rig, --model, --label");
  }
  PLEAT_ASSIGN_OR_RETURN(const MeshSequence truth,
                         ReadInput(session, options.inputs[0], options.fps, notes));
  PLEAT_ASSIGN_OR_RETURN(const std::shared_ptr<const CharacterModel> model,
                         LoadModel(session, options.inputs[1]));
  std::vector<int> frames = options.sheet.frames;
  if (frames.empty()) frames = SpacedFrames(truth.num_frames(), options.sheet.count);
  PLEAT_RETURN_IF_ERROR(CheckFrames(truth.name(), truth, frames));
  PLEAT_ASSIGN_OR_RETURN(ModelAnimations animations, AnimateModel(model, truth, frames, session));
  return RenderErrorSheet(
      truth.Subset(frames), frames,
      {{"skinned only", std::move(animations.skinned)}, {"hybrid", std::move(animations.hybrid)}},
      {.scale_mm = options.scale_mm,
       .azimuth_degrees = options.azimuth_degrees.value_or(model->record().yaw_degrees),
       .tile_width = options.sheet.tile_width,
       .tile_height = options.sheet.tile_height});
}

RigSheetRow::View ViewOf(const std::string& label, const Rig& rig, const Pose& pose,
                         const Eigen::Matrix3Xd& positions) {
  BoneTransforms transforms;
  ComputeBoneTransforms(rig.skeleton, pose, {}, &transforms);
  return {label, positions, transforms.joint_positions};
}

RigSheetRow ModelRigRow(const std::string& label, const CharacterModel& model) {
  const Rig& rig = model.rig();
  return {label,
          model.topology(),
          rig.skeleton,
          model.record().yaw_degrees,
          {ViewOf("rest", rig, Pose::Rest(rig.skeleton), rig.rest_positions)}};
}

// Returns the automatic rig of a sequence: its rest frame, and the given frames in the poses that
// were fitted to them.
absl::StatusOr<RigSheetRow> SequenceRigRow(const std::string& label, const MeshSequence& sequence,
                                           const std::vector<int>& frames, const Session& session) {
  PLEAT_RETURN_IF_ERROR(CheckFrames(label, sequence, frames));
  ProgressDisplay display(*session.err, ChooseProgressStyle(session), MonotonicSeconds);
  const Progress progress = InterruptibleProgress(&display);
  AutoRigSummary summary;
  PLEAT_ASSIGN_OR_RETURN(const Rig rig, AutoRig(sequence, {}, &summary,
                                                progress.Stage("rig", 0, frames.empty() ? 1 : .5)));
  RigSheetRow row{label, sequence.topology(), rig.skeleton, summary.yaw_degrees, {}};
  row.views.push_back(ViewOf(absl::StrCat("rest: frame ", summary.rest_frame), rig,
                             Pose::Rest(rig.skeleton), rig.rest_positions));
  if (frames.empty()) return row;
  PLEAT_ASSIGN_OR_RETURN(const PoseTrack track, FitPoses(sequence.Subset(frames), rig, {}, nullptr,
                                                         progress.Stage("fit", .5, 1)));
  for (size_t k = 0; k < frames.size(); ++k) {
    row.views.push_back(ViewOf(absl::StrCat("frame ", frames[k]), rig, track.pose(k),
                               sequence.FrameAsDouble(frames[k])));
  }
  return row;
}

absl::StatusOr<std::string> DrawRigs(const RenderVerbOptions& options, const Session& session,
                                     std::vector<InputNote>* notes) {
  if (!options.model.empty() || options.azimuth_degrees) {
    return UsageError("--rig goes with neither --model nor --azimuth; a model is an INPUT there");
  }
  std::vector<RigSheetRow> rows;
  for (size_t i = 0; i < options.inputs.size(); ++i) {
    const std::string& input = options.inputs[i];
    const std::string label = i < options.labels.size() ? options.labels[i] : "";
    if (absl::EndsWith(input, ".pleat")) {
      PLEAT_ASSIGN_OR_RETURN(const std::shared_ptr<const CharacterModel> model,
                             LoadModel(session, input));
      rows.push_back(ModelRigRow(label.empty() ? model->name() : label, *model));
      continue;
    }
    PLEAT_ASSIGN_OR_RETURN(const MeshSequence sequence,
                           ReadInput(session, input, options.fps, notes));
    PLEAT_ASSIGN_OR_RETURN(RigSheetRow row,
                           SequenceRigRow(label.empty() ? sequence.name() : label, sequence,
                                          options.sheet.frames, session));
    rows.push_back(std::move(row));
  }
  return RenderRigSheet(rows, {options.sheet.tile_width, options.sheet.tile_height});
}

absl::StatusOr<std::string> DrawSheet(RenderVerbOptions options, const Session& session,
                                      std::vector<InputNote>* notes) {
  std::vector<SheetRow> rows;
  for (size_t i = 0; i < options.inputs.size(); ++i) {
    PLEAT_ASSIGN_OR_RETURN(MeshSequence sequence,
                           ReadInput(session, options.inputs[i], options.fps, notes));
    std::string label = i < options.labels.size() ? options.labels[i] : sequence.name();
    rows.push_back({std::move(label), std::move(sequence)});
  }
  if (!options.model.empty()) {
    PLEAT_ASSIGN_OR_RETURN(const std::shared_ptr<const CharacterModel> model,
                           LoadModel(session, options.model));
    const MeshSequence& input = rows[0].sequence;
    std::vector<int> all(input.num_frames());
    std::iota(all.begin(), all.end(), 0);
    PLEAT_ASSIGN_OR_RETURN(ModelAnimations animations, AnimateModel(model, input, all, session));
    rows.insert(rows.begin() + 1, {{"skinned only", std::move(animations.skinned)},
                                   {"hybrid", std::move(animations.hybrid)}});
    options.sheet.azimuth_degrees = model->record().yaw_degrees;
  }
  if (options.azimuth_degrees) options.sheet.azimuth_degrees = *options.azimuth_degrees;
  return RenderSheet(rows, options.sheet);
}

absl::Status RunRender(RenderVerbOptions options, const Session& session) {
  if (options.labels.size() > options.inputs.size()) {
    return UsageError("there are more --label than inputs");
  }
  if (!options.frames.empty()) {
    PLEAT_ASSIGN_OR_RETURN(options.sheet.frames, ParseFrameList(options.frames));
  }
  PLEAT_RETURN_IF_ERROR(CheckOutputFiles(session, {{"-o", options.output, {".png"}}}));
  options.sheet.count = options.count.value_or(options.compare ? 4 : options.sheet.count);
  std::vector<InputNote> notes;
  PLEAT_ASSIGN_OR_RETURN(const std::string png,
                         options.compare ? DrawComparison(options, session, &notes)
                         : options.rig   ? DrawRigs(options, session, &notes)
                                         : DrawSheet(options, session, &notes));
  PLEAT_RETURN_IF_ERROR(WriteFile(options.output, png));
  if (session.json) {
    const nlohmann::ordered_json json = {{"schema", "pleat.render/1"},
                                         {"output", options.output},
                                         {"input_notes", InputNotesJson(notes)}};
    *session.out << JsonText(json);
  } else {
    *session.out << options.output << "\n";
  }
  return absl::OkStatus();
}

}  // namespace

void AddRenderVerb(CLI::App& app, Session& session) {
  auto options = std::make_shared<RenderVerbOptions>();
  CLI::App* verb = AddVerb(app, session, "render", "draw a contact sheet, one row per input",
                           [options, &session] { return RunRender(*options, session); });
  verb->add_option("INPUT", options->inputs, "one row each; also a folder of Draco frames")
      ->required();
  verb->add_option("-o,--output", options->output, "PNG file")->required();
  verb->add_option("--label", options->labels, "title of a row, in the order of the inputs");
  CLI::Option* frames = verb->add_option("--frames", options->frames, "frames to show: 0,10,20");
  verb->add_option("--count", options->count,
                   "number of evenly spaced frames to show [8; 4 with --compare]")
      ->check(CLI::Range(1, 200))
      ->excludes(frames);
  verb->add_option("--model", options->model,
                   "adds the rows 'skinned only' and 'hybrid' for the first input");
  verb->add_option(
      "--azimuth", options->azimuth_degrees,
      "where the viewer stands about +y, degrees from +z [the model's facing, else 0]");
  verb->add_option("--tile-width", options->sheet.tile_width, "pixels")
      ->check(CLI::Range(32, 2048))
      ->capture_default_str();
  verb->add_option("--tile-height", options->sheet.tile_height, "pixels")
      ->check(CLI::Range(32, 2048))
      ->capture_default_str();
  verb->add_flag("--rig", options->rig,
                 "draw mesh and skeleton from two sides: the rig of a model (.pleat), or the "
                 "automatic one of a sequence in its rest frame and in --frames");
  verb->add_flag("--compare", options->compare,
                 "INPUT is a sequence and a model: skinned only and hybrid, colored by the "
                 "distance of every vertex from the sequence, beside it");
  verb->add_option("--scale-mm", options->scale_mm,
                   "with --compare: error at the end of the color scale, mm")
      ->check(CLI::Range(1e-3, 1e6))
      ->capture_default_str();
  verb->add_option("--fps", options->fps, "frames per second, where the inputs do not say");
  AddObjectFlag(verb, session);
  AddForceFlag(verb, session);
  AddServerFlags(verb, session);
}

}  // namespace pleat
