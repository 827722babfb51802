#include "cli/verbs/train_flags.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "cli/exit_code.h"

namespace pleat {
namespace {

struct FlagText {
  const char* alias;  // a second, shorter flag, or nullptr
  const char* help;
};

const std::map<std::string, FlagText>& FlagTexts() {
  static const auto& texts = *new std::map<std::string, FlagText>{
      {"learner",
       {nullptr,
        "auto (chosen on held-out training frames), regional, gp, sgplvm (the paper's), "
        "back-constrained (sgplvm with latent points that follow the pose) or ridge"}},
      {"fit",
       {nullptr, "pose fit: all-joints (all at once) or walk (the paper's, root to leaves)"}},
      {"refine",
       {nullptr,
        "rig on the training frames: none, joints, or full (joints, weights and rest mesh)"}},
      {"detail_axes", {"axes", "axes of the details: local, root or world (the paper's)"}},
      {"deformation",
       {nullptr, "what is learned: fine (details beyond skinning) or full (all deformation)"}},
      {"detail_coordinates",
       {nullptr, "details as offsets, or differential (against the mean of their neighbors)"}},
      {"rotations", {nullptr, "rotations as features: expmap (the paper's), euler or quaternion"}},
      {"history", {nullptr, "poses per feature row, 1 to 8 (paper: 2)"}},
      {"history_form", {nullptr, "differences (speeds) or poses (the paper's) of that history"}},
      {"upsampling", {nullptr, "control mesh to all vertices: rbf (the paper's) or refined"}},
      {"bend_stiffness", {nullptr, "pose fit: pull of every bone towards its parent, 0 to 1"}},
      {"smoothness",
       {"smooth", "pose fit: pull to the poses before and after, 0 to 1 (.01 calms noise)"}},
      {"resolution_percent",
       {"resolution", "percent of the vertices that learn, 1 to 100 (paper: 5)"}},
      {"rest_frame", {nullptr, "frame to rig; -1 finds it"}},
      {"yaw_degrees", {"yaw", "facing about +y from +z in degrees; -1 finds it"}},
      {"latent_dimensions", {nullptr, "latent dimensions of sgplvm, 1 to 32"}},
      {"iterations", {nullptr, "optimizer iterations of sgplvm, 1 to 10000 (paper: 100)"}},
      {"dynamics_weight", {nullptr, "weight of sgplvm's dynamics term (paper: 1)"}},
      {"detail_energy", {nullptr, "share of the details' energy that the basis keeps, 0 to 1"}},
      {"max_components", {nullptr, "upper bound of the detail basis, 1 to 1024"}},
      {"seed", {nullptr, "seed of everything random"}},
  };
  return texts;
}

std::string FlagNames(const std::string& option) {
  std::string names = absl::StrCat("--", absl::StrReplaceAll(option, {{"_", "-"}}));
  const auto text = FlagTexts().find(option);
  if (text != FlagTexts().end() && text->second.alias != nullptr) {
    absl::StrAppend(&names, ",--", text->second.alias);
  }
  return names;
}

}  // namespace

void AddTrainFlags(CLI::App* verb, TrainFlags* flags) {
  const std::string group = "Training options";
  verb->add_option("--preset", flags->preset,
                   "starting values: default, or paper (the published settings)")
      ->check(CLI::IsMember({"default", "paper"}))
      ->group(group);
  const TrainOptions defaults;
  VisitTrainOptions(defaults, [&](const char* name, const auto& value) {
    const auto text = FlagTexts().find(name);
    std::string help = text == FlagTexts().end() ? std::string() : text->second.help;
    absl::StrAppend(&help, " [", value, "]");
    verb->add_option_function<std::string>(
            FlagNames(name),
            [flags, option = std::string(name)](const std::string& given) {
              flags->values[option] = given;
            },
            help)
        ->type_name("")
        ->group(group);
  });
}

absl::StatusOr<TrainOptions> ResolveTrainFlags(const TrainFlags& flags) {
  std::string text =
      FormatTrainOptions(flags.preset == "paper" ? TrainOptions::Paper() : TrainOptions());
  for (const auto& [name, value] : flags.values) {
    if (value.find('\n') != std::string::npos) {
      return UsageError(absl::StrCat("the value of ", FlagNames(name), " has a line break"));
    }
    absl::StrAppend(&text, name, "=", value, "\n");
  }
  absl::StatusOr<TrainOptions> options = ParseTrainOptions(text);
  if (!options.ok()) return UsageError(std::string(options.status().message()));
  return options;
}

}  // namespace pleat
