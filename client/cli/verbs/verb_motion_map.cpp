// motion map CLIP -o map.json: writes the table by which a clip of another skeleton would drive a
// character, to read and to edit.
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "cli/exit_code.h"
#include "cli/io/model_input.h"
#include "cli/io/output_path.h"
#include "cli/show/json_text.h"
#include "cli/show/text_table.h"
#include "cli/verbs/motion_verbs.h"
#include "cli/verbs/verbs.h"
#include "pleat/base/status.h"
#include "pleat/base/utf8.h"
#include "pleat/formats/joint_clip_reader.h"
#include "pleat/formats/joint_map_file.h"
#include "pleat/motion/default_joint_map.h"
#include "pleat/skeleton/human_template.h"

namespace pleat {
namespace {

struct MapVerbOptions {
  std::string clip, model, output;
};

absl::Status RunMap(const MapVerbOptions& options, const Session& session) {
  PLEAT_RETURN_IF_ERROR(CheckOutputFiles(session, {{"-o", options.output, {".json"}}}));
  std::shared_ptr<const CharacterModel> model;
  if (!options.model.empty()) {
    PLEAT_ASSIGN_OR_RETURN(model, LoadModel(session, options.model));
  }
  PLEAT_ASSIGN_OR_RETURN(const JointClipFile file, ReadJointClip(options.clip));
  for (const std::string& warning : file.warnings) *session.err << "warning: " << warning << "\n";
  PLEAT_ASSIGN_OR_RETURN(
      const JointMap map,
      WithContext(options.clip,
                  MakeJointMap(file.clip, model ? model->skeleton() : HumanTemplate())));
  PLEAT_RETURN_IF_ERROR(WriteJointMap(options.output, map));
  size_t num_mapped = 0;
  std::vector<std::vector<std::string>> rows;
  for (const JointMapEntry& entry : map.joints) {
    num_mapped += entry.from.empty() ? 0 : 1;
    rows.push_back({EscapeControls(entry.joint), EscapeControls(entry.from),
                    EscapeControls(entry.turns_with),
                    entry.from.empty() ? "" : std::string(BoneAlignmentName(entry.alignment))});
  }
  if (session.json) {
    *session.out << JsonText({{"schema", "pleat.joint_map_written/1"},
                              {"output", options.output},
                              {"num_mapped", num_mapped},
                              {"num_joints", map.joints.size()},
                              {"num_left_out", map.left_out.size()}});
    return absl::OkStatus();
  }
  *session.out << FormatTable({"joint", "from", "turns with", "align"}, rows) << options.output
               << ": " << num_mapped << " of " << map.joints.size() << " joints are driven, "
               << map.left_out.size() << " joints of the clip are left out\n";
  return absl::OkStatus();
}

}  // namespace

CLI::App* AddVerbOfMotion(CLI::App& motion, Session& session, const std::string& name,
                          const std::string& description, std::function<absl::Status()> run) {
  CLI::App* verb = AddVerb(motion, session, name, description, run);
  verb->callback([&session, name, run = std::move(run)] {
    session.verb = "motion " + name;
    session.run = run;
  });
  return verb;
}

void AddMotionMapVerb(CLI::App& motion, Session& session) {
  auto options = std::make_shared<MapVerbOptions>();
  CLI::App* verb = AddVerbOfMotion(motion, session, "map",
                                   "write which joints of a clip drive which bones, to edit",
                                   [options, &session] { return RunMap(*options, session); });
  verb->add_option("CLIP", options->clip, "a clip of another skeleton (.bvh, .glb, .gltf)")
      ->required();
  verb->add_option("-o,--output", options->output, "joint map (.json)")->required();
  verb->add_option("--model", options->model,
                   "the character, where it has a skeleton of its own [the human template]");
  AddForceFlag(verb, session);
  AddServerFlags(verb, session);
}

}  // namespace pleat
