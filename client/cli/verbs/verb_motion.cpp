// motion MODEL SOURCE -o motion.json: writes the poses of a mesh sequence, of a motion file, or of
// a clip of another skeleton, with edits. Its own verbs (map, edit, undo) are beside it.
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "absl/strings/str_format.h"
#include "cli/exit_code.h"
#include "cli/io/model_input.h"
#include "cli/io/motion_edit.h"
#include "cli/io/output_path.h"
#include "cli/io/retarget_input.h"
#include "cli/show/json_text.h"
#include "cli/show/retarget_report.h"
#include "cli/verbs/motion_verbs.h"
#include "cli/verbs/verbs.h"
#include "pleat/base/file.h"
#include "pleat/base/status.h"
#include "pleat/formats/edited_motion_file.h"
#include "pleat/formats/motion_file.h"

namespace pleat {
namespace {

struct MotionVerbOptions {
  std::string model, output;
  RetargetInput input;
  std::vector<std::string> bone_scales;
  MotionEdits edits;
};

void PrintWritten(const MotionVerbOptions& options, const Motion& motion,
                  const std::optional<RetargetSummary>& summary, const Session& session) {
  if (session.json) {
    nlohmann::ordered_json json = {{"schema", "pleat.motion_written/1"},
                                   {"output", options.output},
                                   {"num_frames", motion.track.num_frames()},
                                   {"num_joints", motion.track.num_joints()}};
    if (summary) json["retargeting"] = RetargetJson(*summary);
    *session.out << JsonText(json);
    return;
  }
  if (summary) *session.out << RetargetText(*summary);
  *session.out << absl::StrFormat("%s: %d frames of %d joints\n", options.output,
                                  motion.track.num_frames(), motion.track.num_joints());
}

absl::Status RunMotion(const MotionVerbOptions& options, const Session& session) {
  if (options.model.empty() || options.input.source.empty() || options.output.empty()) {
    return UsageError(
        "'pleat motion MODEL SOURCE -o FILE' needs a model, a source and -o; 'pleat motion --help' "
        "lists its other forms");
  }
  PLEAT_RETURN_IF_ERROR(CheckOutputFiles(session, {{"-o", options.output, {".json"}}}));
  PLEAT_ASSIGN_OR_RETURN(const std::shared_ptr<const CharacterModel> model,
                         LoadModel(session, options.model));
  const std::vector<std::string> joint_names = JointNames(model->skeleton());
  std::optional<RetargetSummary> summary = RetargetSummary();
  PLEAT_ASSIGN_OR_RETURN(std::optional<Motion> motion,
                         RetargetForeignClip(options.input, *model, &*summary));
  if (!motion.has_value()) {
    if (options.input.clean_feet) {
      return UsageError(
          "--clean-feet is for clips of other skeletons; 'pleat motion edit FILE --clean-feet' "
          "cleans any motion");
    }
    summary.reset();
    PLEAT_ASSIGN_OR_RETURN(motion,
                           LoadMotion(options.input.source, options.input.fps, *model, session));
  }
  for (const std::string& warning : motion->warnings) {
    *session.err << "warning: " << warning << "\n";
  }
  PLEAT_ASSIGN_OR_RETURN(motion->track,
                         EditMotion(joint_names, std::move(motion->track), options.edits));
  PLEAT_ASSIGN_OR_RETURN(std::vector<double> scales,
                         ParseJointFactors(joint_names, options.bone_scales));
  if (!scales.empty()) motion->bone_scales = std::move(scales);
  // With the skeleton of the character, so that later edits need no model.
  PLEAT_RETURN_IF_ERROR(
      WriteFile(options.output, EncodeMotionWithSkeleton(model->skeleton(), *motion)));
  PrintWritten(options, *motion, summary, session);
  return absl::OkStatus();
}

}  // namespace

void AddMotionVerb(CLI::App& app, Session& session) {
  auto options = std::make_shared<MotionVerbOptions>();
  CLI::App* verb = AddVerb(app, session, "motion",
                           "take the motion from a sequence or another skeleton, edit motions",
                           [] { return absl::OkStatus(); });
  // The callback of a parser runs after those of the verbs below it.
  verb->callback([options, &session, verb] {
    if (!verb->get_subcommands().empty()) return;
    session.verb = "motion";
    session.run = [options, &session] { return RunMotion(*options, session); };
  });
  verb->add_option("MODEL", options->model, "a .pleat file, or the id of a model on the server");
  verb->add_option("SOURCE", options->input.source,
                   "a motion (.json, .bvh, .glb), a .bvh of any skeleton, or a mesh sequence of "
                   "the model's connectivity");
  verb->add_option("-o,--output", options->output, "motion file (.json)");
  verb->add_option("--fps", options->input.fps, "frames per second, where SOURCE does not say");
  AddObjectFlag(verb, session);
  verb->add_flag("--retarget", options->input.required,
                 "SOURCE (.bvh, .glb) is of another skeleton; found out by itself for a .bvh");
  verb->add_option("--map", options->input.map,
                   "joint map (.json, from 'pleat motion map') for another skeleton");
  verb->add_flag("--clean-feet", options->input.clean_feet,
                 "of another skeleton: holds feet still while they stand");
  verb->add_option("--scale-rotation", options->edits.scale_rotation,
                   "JOINT=FACTOR: more or less of the motion of the bone that ends in JOINT "
                   "(leftLowerArm is the upper arm); JOINT 'all' is every bone");
  verb->add_option("--offset-rotation", options->edits.offset_rotation,
                   "JOINT=X,Y,Z: turns that bone further, degrees");
  verb->add_option("--offset-root", options->edits.offset_root, "X,Y,Z: moves it, meters");
  verb->add_option("--time-scale", options->edits.time_scale, "duration times this")
      ->capture_default_str();
  verb->add_option("--bone-scale", options->bone_scales,
                   "JOINT=FACTOR: length of the bone that ends in JOINT, kept in the motion");
  AddForceFlag(verb, session);
  AddServerFlags(verb, session);
  AddMotionMapVerb(*verb, session);
  AddMotionEditVerb(*verb, session);
  AddMotionUndoVerb(*verb, session);
}

}  // namespace pleat
