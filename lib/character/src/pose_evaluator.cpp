#include "pleat/character/pose_evaluator.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "absl/strings/str_cat.h"
#include "option_values.h"
#include "pleat/base/status.h"
#include "pleat/fitting/details.h"
#include "pleat/gp/detail_model.h"
#include "pleat/skeleton/pose_history.h"
#include "pleat/skinning/rig.h"

namespace pleat {

struct PoseEvaluator::Scratch {
  std::vector<Pose> history;  // normalised copies, [0] = pose to show
  std::vector<const Pose*> history_pointers;
  BoneTransforms transforms;
  Eigen::Matrix3Xd skinned;                   // 3 x V
  std::vector<int> all_vertices;              // 0 .. V-1
  std::vector<Eigen::Quaterniond> rotations;  // V, axes of the details
  Eigen::Matrix3Xd hybrid;                    // 3 x V
  Eigen::VectorXd features;                   // D_S
  Eigen::VectorXf coefficients;               // r
  Eigen::VectorXf details;                    // 3V
  DetailModel::Workspace workspace;
};

namespace {

constexpr double kMinBoneScale = 0.05, kMaxBoneScale = 20;

absl::Status CheckPose(const Pose& pose, int num_joints) {
  if (static_cast<int>(pose.rotations.size()) != num_joints) {
    return absl::InvalidArgumentError(absl::StrCat("the pose has ", pose.rotations.size(),
                                                   " rotations, the skeleton has ", num_joints,
                                                   " joints"));
  }
  if (!pose.root_position.allFinite()) {
    return absl::InvalidArgumentError("the pose's root position is not finite");
  }
  for (int j = 0; j < num_joints; ++j) {
    const double norm = pose.rotations[j].norm();
    if (!(std::abs(norm - 1) < 1e-2)) {  // written so that a NaN fails
      return absl::InvalidArgumentError(
          absl::StrCat("rotation of joint ", j, " has norm ", norm, "; send unit quaternions"));
    }
  }
  return absl::OkStatus();
}

absl::Status CheckBoneScales(const std::vector<double>& bone_scales, int num_joints) {
  if (bone_scales.empty()) return absl::OkStatus();
  if (static_cast<int>(bone_scales.size()) != num_joints) {
    return absl::InvalidArgumentError(absl::StrCat(bone_scales.size(), " bone scales for ",
                                                   num_joints, " joints; give all or none"));
  }
  for (int j = 0; j < num_joints; ++j) {
    if (!(bone_scales[j] >= kMinBoneScale && bone_scales[j] <= kMaxBoneScale)) {
      return absl::InvalidArgumentError(absl::StrCat("bone scale ", bone_scales[j], " of joint ", j,
                                                     " is outside ", kMinBoneScale, " to ",
                                                     kMaxBoneScale));
    }
  }
  return absl::OkStatus();
}

// Assigns without allocating once `target` has the right size.
void CopyNormalized(const Pose& source, Pose* target) {
  target->root_position = source.root_position;
  target->rotations.resize(source.rotations.size());
  for (size_t j = 0; j < source.rotations.size(); ++j) {
    target->rotations[j] = source.rotations[j].normalized();
  }
}

}  // namespace

PoseEvaluator::PoseEvaluator(std::shared_ptr<const CharacterModel> model)
    : model_(std::move(model)), scratch_(std::make_unique<Scratch>()) {
  const int history = model_->options().history;
  scratch_->history.resize(history);
  for (Pose& pose : scratch_->history) {
    pose = Pose::Rest(model_->skeleton());
    scratch_->history_pointers.push_back(&pose);
  }
  scratch_->all_vertices.resize(model_->num_vertices());
  std::iota(scratch_->all_vertices.begin(), scratch_->all_vertices.end(), 0);
  scratch_->features.resize(model_->features().num_features());
  scratch_->coefficients.resize(model_->full_basis().cols());
  scratch_->details.resize(model_->full_basis().rows());
}

PoseEvaluator::~PoseEvaluator() = default;
PoseEvaluator::PoseEvaluator(PoseEvaluator&&) noexcept = default;
PoseEvaluator& PoseEvaluator::operator=(PoseEvaluator&&) noexcept = default;

const CharacterModel& PoseEvaluator::model() const { return *model_; }

absl::Status PoseEvaluator::Evaluate(const std::vector<const Pose*>& poses,
                                     const std::vector<double>& bone_scales,
                                     EvaluatedFrame* frame) {
  Scratch& s = *scratch_;
  if (poses.empty()) return absl::InvalidArgumentError("a pose query needs at least one pose");
  PLEAT_RETURN_IF_ERROR(Skin(*poses[0], bone_scales));
  for (size_t h = 1; h < s.history.size(); ++h) {
    const Pose& pose = *poses[std::min(h, poses.size() - 1)];
    PLEAT_RETURN_IF_ERROR(CheckPose(pose, model_->skeleton().num_joints()));
    CopyNormalized(pose, &s.history[h]);
  }
  model_->features().ComputeRow(s.history_pointers, s.features);
  frame->confidence =
      model_->detail_model().PredictCoefficients(s.features, &s.workspace, s.coefficients);
  s.details = model_->full_mean();
  s.details.noalias() += model_->full_basis() * s.coefficients;

  if (DetailBaseOf(model_->options()) == DetailBase::kRoot) {
    ComputeDetailBase(DetailBase::kRoot, model_->rig(), s.transforms, &s.skinned);
  }
  ComputeDetailRotations(DetailAxesOf(model_->options()), model_->rig().weights, s.all_vertices,
                         s.transforms, &s.rotations);
  ApplyDetails(s.skinned, s.rotations, s.details, &s.hybrid);
  frame->positions = s.hybrid.cast<float>();
  return absl::OkStatus();
}

absl::Status PoseEvaluator::EvaluateSkinned(const Pose& pose,
                                            const std::vector<double>& bone_scales,
                                            EvaluatedFrame* frame) {
  PLEAT_RETURN_IF_ERROR(Skin(pose, bone_scales));
  frame->positions = scratch_->skinned.cast<float>();
  frame->confidence = 1;
  return absl::OkStatus();
}

absl::Status PoseEvaluator::Skin(const Pose& pose, const std::vector<double>& bone_scales) {
  Scratch& s = *scratch_;
  PLEAT_RETURN_IF_ERROR(CheckPose(pose, model_->skeleton().num_joints()));
  PLEAT_RETURN_IF_ERROR(CheckBoneScales(bone_scales, model_->skeleton().num_joints()));
  CopyNormalized(pose, &s.history[0]);
  ComputeBoneTransforms(model_->skeleton(), s.history[0], bone_scales, &s.transforms);
  SkinVertices(model_->rig().weights, model_->rig().rest_positions, s.transforms, &s.skinned);
  return absl::OkStatus();
}

absl::Status PoseEvaluator::EvaluateClip(
    const PoseTrack& track, const std::vector<double>& bone_scales,
    const std::function<absl::Status(int, const EvaluatedFrame&)>& consume,
    const Progress& progress) {
  for (int t = 0; t < track.num_frames(); ++t) {
    if (absl::Status status = CheckPose(track.poses[t], model_->skeleton().num_joints());
        !status.ok()) {
      return absl::InvalidArgumentError(
          absl::StrCat("frame ", t, ": ", absl::string_view(status.message())));
    }
  }
  PoseHistory history(track, model_->frame_rate().fps(), model_->options().history);
  std::vector<const Pose*> poses;
  EvaluatedFrame frame;
  for (int t = 0; t < track.num_frames(); ++t) {
    history.At(t, &poses);
    PLEAT_RETURN_IF_ERROR(Evaluate(poses, bone_scales, &frame));
    PLEAT_RETURN_IF_ERROR(consume(t, frame));
    PLEAT_RETURN_IF_ERROR(progress.Report((t + 1.0) / track.num_frames()));
  }
  return absl::OkStatus();
}

}  // namespace pleat
