#include "pleat/character/option_choices.h"

#include <array>
#include <cassert>

namespace pleat {

template <>
std::span<const NamedChoice<LearnerChoice>> ChoicesOf() {
  static constexpr NamedChoice<LearnerChoice> kChoices[] = {
      {LearnerChoice::kAuto, "auto", "chosen on held-out training frames"},
      {LearnerChoice::kRegional, "regional",
       "Gaussian processes per bone and per patch of the surface"},
      {LearnerChoice::kRegionalFast, "regional-fast", "Gaussian processes per bone alone"},
      {LearnerChoice::kGp, "gp", "one Gaussian process"},
      {LearnerChoice::kSgplvm, "sgplvm", "the paper's shared GPLVM"},
      {LearnerChoice::kBackConstrained, "back-constrained",
       "sgplvm with latent points that follow the pose"},
      {LearnerChoice::kRidge, "ridge", "linear"},
  };
  return kChoices;
}

template <>
std::span<const NamedChoice<PoseFitMethod>> ChoicesOf() {
  static constexpr NamedChoice<PoseFitMethod> kChoices[] = {
      {PoseFitMethod::kAllJoints, "all-joints", "all at once"},
      {PoseFitMethod::kWalk, "walk", "the paper's, root to leaves"},
  };
  return kChoices;
}

template <>
std::span<const NamedChoice<RigRefinement>> ChoicesOf() {
  static constexpr NamedChoice<RigRefinement> kChoices[] = {
      {RigRefinement::kNone, "none", "as it was found, as in the paper"},
      {RigRefinement::kJoints, "joints", "the rest joints"},
      {RigRefinement::kFull, "full", "joints, weights and rest mesh"},
  };
  return kChoices;
}

template <>
std::span<const NamedChoice<DetailBase>> ChoicesOf() {
  static constexpr NamedChoice<DetailBase> kChoices[] = {
      {DetailBase::kSkinned, "fine", "details beyond skinning"},
      {DetailBase::kRoot, "full", "all deformation"},
  };
  return kChoices;
}

template <>
std::span<const NamedChoice<DetailAxes>> ChoicesOf() {
  static constexpr NamedChoice<DetailAxes> kChoices[] = {
      {DetailAxes::kLocal, "local", "those of each vertex's own blend"},
      {DetailAxes::kRoot, "root", "those of the body"},
      {DetailAxes::kWorld, "world", "the paper's"},
  };
  return kChoices;
}

template <>
std::span<const NamedChoice<DetailCoordinates>> ChoicesOf() {
  static constexpr NamedChoice<DetailCoordinates> kChoices[] = {
      {DetailCoordinates::kOffsets, "offsets", "the paper's"},
      {DetailCoordinates::kDifferential, "differential", "against the mean of the neighbors"},
  };
  return kChoices;
}

template <>
std::span<const NamedChoice<RotationRepresentation>> ChoicesOf() {
  static constexpr NamedChoice<RotationRepresentation> kChoices[] = {
      {RotationRepresentation::kExponentialMap, "expmap", "exponential maps, the paper's"},
      {RotationRepresentation::kEuler, "euler", "Euler angles"},
      {RotationRepresentation::kQuaternion, "quaternion", "unit quaternions"},
  };
  return kChoices;
}

template <>
std::span<const NamedChoice<HistoryForm>> ChoicesOf() {
  static constexpr NamedChoice<HistoryForm> kChoices[] = {
      {HistoryForm::kDifferences, "differences", "speeds"},
      {HistoryForm::kPoses, "poses", "the paper's"},
  };
  return kChoices;
}

template <>
std::span<const NamedChoice<Upsampling>> ChoicesOf() {
  static constexpr NamedChoice<Upsampling> kChoices[] = {
      {Upsampling::kRefined, "refined", "weights learned from the input"},
      {Upsampling::kRbf, "rbf", "radial basis functions, the paper's"},
  };
  return kChoices;
}

template <>
std::span<const NamedChoice<JumpPolicy>> ChoicesOf() {
  static constexpr NamedChoice<JumpPolicy> kChoices[] = {
      {JumpPolicy::kRefuse, "refuse", "training is refused, with the frame numbers"},
      {JumpPolicy::kAllow, "allow", "they are taken as they are"},
  };
  return kChoices;
}

std::span<const OptionText> OptionTexts() {
  static constexpr OptionText kTexts[] = {
      {"learner", nullptr, "what predicts the details"},
      {"fit", nullptr, "pose fit"},
      {"refine", nullptr, "what of the rig is refined on the training frames"},
      {"influences", nullptr, "bones that may move a vertex after full refinement, 1 to 8"},
      {"deformation", nullptr, "what is learned"},
      {"detail_axes", "axes", "axes of the details"},
      {"detail_coordinates", nullptr, "coordinates of the details"},
      {"rotations", nullptr, "rotations as features"},
      {"history", nullptr, "poses per feature row, 1 to 8"},
      {"history_form", nullptr, "the earlier poses of a feature row"},
      {"resolution_percent", "resolution", "percent of the vertices that learn, 1 to 100"},
      {"upsampling", nullptr, "from the control mesh to all vertices"},
      {"rest_frame", nullptr, "frame to rig; -1 finds it"},
      {"yaw_degrees", "yaw", "facing about +y from +z in degrees; -1 finds it"},
      {"bend_stiffness", nullptr, "pose fit: pull of every bone toward its parent, 0 to 1"},
      {"smoothness", "smooth",
       "pose fit: pull to the poses before and after, 0 to 1 (.01 calms noise)"},
      {"latent_dimensions", nullptr, "latent dimensions of sgplvm, 1 to 32"},
      {"iterations", nullptr, "optimizer iterations of sgplvm, 1 to 10000"},
      {"dynamics_weight", nullptr, "weight of the dynamics term of sgplvm, 0 to 1e6"},
      {"detail_energy", nullptr, "share of the details' energy that the basis keeps, 0 to 1"},
      {"max_components", nullptr, "upper bound of the detail basis, 1 to 1024"},
      {"seed", nullptr, "seed of everything random"},
      {"jumps", nullptr, "clips with frames that jump to another size or vertex order"},
      {"placed_joints", "at",
       "joints that you place in the rest frame, NAME=x,y,z in meters (leftHand=.7,1.4,0)"},
  };
  return kTexts;
}

const OptionText& TextOfOption(absl::string_view name) {
  for (const OptionText& text : OptionTexts()) {
    if (text.name == name) return text;
  }
  assert(false && "an option without a text");
  return OptionTexts().front();
}

}  // namespace pleat
