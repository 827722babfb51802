// render INPUT... -o sheet.png: a contact sheet, one row per input.
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "cli/exit_code.h"
#include "cli/input.h"
#include "cli/model_input.h"
#include "cli/progress_display.h"
#include "cli/rig_sheet.h"
#include "cli/sheet.h"
#include "cli/verbs.h"
#include "pleat/base/file.h"
#include "pleat/base/status.h"
#include "pleat/character/pose_evaluator.h"
#include "pleat/fitting/pose_fit.h"
#include "pleat/rigging/auto_rig.h"

namespace pleat {
namespace {

struct RenderVerbOptions {
  std::vector<std::string> inputs, labels;
  std::string output, frames, model, fps;
  std::optional<double> azimuth_degrees;
  SheetOptions sheet;
  bool rig = false;
};

// The rows that a model adds below its input: what its rig alone makes of the input's poses, and
// what rig and learnt detail make of them.
absl::Status AddModelRows(std::shared_ptr<const CharacterModel> model, const MeshSequence& input,
                          const Session& session, std::vector<SheetRow>* rows) {
  PLEAT_ASSIGN_OR_RETURN(const PoseTrack track, FitMotionWithProgress(*model, input, session));
  std::vector<Eigen::Matrix3Xf> skinned, hybrid;
  PoseEvaluator evaluator(std::move(model));
  EvaluatedFrame frame;
  for (const Pose& pose : track.poses) {
    PLEAT_RETURN_IF_ERROR(evaluator.EvaluateSkinned(pose, {}, &frame));
    skinned.push_back(frame.positions);
  }
  PLEAT_RETURN_IF_ERROR(
      evaluator.EvaluateClip(track, {}, [&hybrid](int, const EvaluatedFrame& evaluated) {
        hybrid.push_back(evaluated.positions);
        return absl::OkStatus();
      }));
  PLEAT_ASSIGN_OR_RETURN(MeshSequence skinned_sequence,
                         MeshSequence::Create(input.topology(), std::move(skinned)));
  PLEAT_ASSIGN_OR_RETURN(MeshSequence hybrid_sequence,
                         MeshSequence::Create(input.topology(), std::move(hybrid)));
  rows->insert(rows->begin() + 1, {{"skinned only", std::move(skinned_sequence)},
                                   {"hybrid", std::move(hybrid_sequence)}});
  return absl::OkStatus();
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

// The automatic rig of a sequence: its rest frame, and the given frames in the poses fitted to
// them.
absl::StatusOr<RigSheetRow> SequenceRigRow(const std::string& label, const MeshSequence& sequence,
                                           const std::vector<int>& frames, const Session& session) {
  for (const int t : frames) {
    if (t < sequence.num_frames()) continue;
    return absl::InvalidArgumentError(absl::StrCat("'", label, "' has no frame ", t, ": it has ",
                                                   sequence.num_frames(), " frames, from 0"));
  }
  ProgressDisplay display(*session.err, ChooseProgressStyle(session), MonotonicSeconds);
  AutoRigSummary summary;
  PLEAT_ASSIGN_OR_RETURN(const Rig rig,
                         AutoRig(sequence, {}, &summary, InterruptibleProgress(&display)));
  RigSheetRow row{label, sequence.topology(), rig.skeleton, summary.yaw_degrees, {}};
  row.views.push_back(ViewOf(absl::StrCat("rest: frame ", summary.rest_frame), rig,
                             Pose::Rest(rig.skeleton), rig.rest_positions));
  if (frames.empty()) return row;
  PLEAT_ASSIGN_OR_RETURN(const PoseTrack track, FitPoses(sequence.Subset(frames), rig, {}, nullptr,
                                                         InterruptibleProgress(&display)));
  for (size_t k = 0; k < frames.size(); ++k) {
    row.views.push_back(ViewOf(absl::StrCat("frame ", frames[k]), rig, track.poses[k],
                               sequence.FrameAsDouble(frames[k])));
  }
  return row;
}

absl::StatusOr<std::string> DrawRigs(const RenderVerbOptions& options, const Session& session) {
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
    PLEAT_ASSIGN_OR_RETURN(const MeshSequence sequence, ReadInput(session, input, options.fps));
    PLEAT_ASSIGN_OR_RETURN(RigSheetRow row,
                           SequenceRigRow(label.empty() ? sequence.name() : label, sequence,
                                          options.sheet.frames, session));
    rows.push_back(std::move(row));
  }
  return RenderRigSheet(rows, {options.sheet.tile_width, options.sheet.tile_height});
}

absl::StatusOr<std::string> DrawSheet(RenderVerbOptions options, const Session& session) {
  std::vector<SheetRow> rows;
  for (size_t i = 0; i < options.inputs.size(); ++i) {
    PLEAT_ASSIGN_OR_RETURN(MeshSequence sequence,
                           ReadInput(session, options.inputs[i], options.fps));
    std::string label = i < options.labels.size() ? options.labels[i] : sequence.name();
    rows.push_back({std::move(label), std::move(sequence)});
  }
  if (!options.model.empty()) {
    PLEAT_ASSIGN_OR_RETURN(const std::shared_ptr<const CharacterModel> model,
                           LoadModel(session, options.model));
    const MeshSequence input = rows[0].sequence;
    PLEAT_RETURN_IF_ERROR(AddModelRows(model, input, session, &rows));
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
  PLEAT_ASSIGN_OR_RETURN(const std::string png,
                         options.rig ? DrawRigs(options, session) : DrawSheet(options, session));
  PLEAT_RETURN_IF_ERROR(WriteFile(options.output, png));
  if (!session.quiet) *session.out << options.output << "\n";
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
  verb->add_option("--count", options->sheet.count, "number of evenly spaced frames to show")
      ->check(CLI::Range(1, 200))
      ->capture_default_str()
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
  verb->add_option("--fps", options->fps, "frames per second, where the inputs do not say");
  AddServerFlags(verb, session);
}

}  // namespace pleat
