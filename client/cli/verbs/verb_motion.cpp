// motion MODEL SOURCE -o motion.json: writes the poses of a mesh sequence, or of a motion file,
// with edits.
#include <memory>
#include <nlohmann/json.hpp>

#include "absl/strings/str_format.h"
#include "cli/io/model_input.h"
#include "cli/io/motion_edit.h"
#include "cli/io/output_path.h"
#include "cli/show/json_text.h"
#include "cli/verbs/verbs.h"
#include "pleat/base/status.h"
#include "pleat/formats/motion_file.h"

namespace pleat {
namespace {

struct MotionVerbOptions {
  std::string model, source, output, fps;
  std::vector<std::string> bone_scales;
  MotionEdits edits;
};

absl::Status RunMotion(const MotionVerbOptions& options, const Session& session) {
  PLEAT_RETURN_IF_ERROR(CheckOutputFiles(session, {{"-o", options.output, {".json"}}}));
  PLEAT_ASSIGN_OR_RETURN(const std::shared_ptr<const CharacterModel> model,
                         LoadModel(session, options.model));
  const std::vector<std::string> joint_names = JointNames(model->skeleton());
  PLEAT_ASSIGN_OR_RETURN(Motion motion, LoadMotion(options.source, options.fps, *model, session));
  for (const std::string& warning : motion.warnings) {
    *session.err << "warning: " << warning << "\n";
  }
  PLEAT_ASSIGN_OR_RETURN(motion.track,
                         EditMotion(joint_names, std::move(motion.track), options.edits));
  PLEAT_ASSIGN_OR_RETURN(const std::vector<double> scales,
                         ParseJointFactors(joint_names, options.bone_scales));
  PLEAT_RETURN_IF_ERROR(WriteMotion(options.output, model->skeleton(), motion.track,
                                    scales.empty() ? motion.bone_scales : scales));
  if (session.json) {
    *session.out << JsonText({{"schema", "pleat.motion_written/1"},
                              {"output", options.output},
                              {"num_frames", motion.track.num_frames()},
                              {"num_joints", joint_names.size()}});
  } else {
    *session.out << absl::StrFormat("%s: %d frames of %d joints\n", options.output,
                                    motion.track.num_frames(), joint_names.size());
  }
  return absl::OkStatus();
}

}  // namespace

void AddMotionVerb(CLI::App& app, Session& session) {
  auto options = std::make_shared<MotionVerbOptions>();
  CLI::App* verb =
      AddVerb(app, session, "motion", "take the motion from a sequence, and edit motions",
              [options, &session] { return RunMotion(*options, session); });
  verb->add_option("MODEL", options->model, "a .pleat file, or the id of a model on the server")
      ->required();
  verb->add_option("SOURCE", options->source,
                   "a motion (.json, .bvh, .glb), or a mesh sequence of the model's connectivity")
      ->required();
  verb->add_option("-o,--output", options->output, "motion file (.json)")->required();
  verb->add_option("--fps", options->fps, "frames per second, where SOURCE does not say");
  AddObjectFlag(verb, session);
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
}

}  // namespace pleat
