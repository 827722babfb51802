// What other packages need of a model to show it themselves: rest mesh, skin and record.
#include <algorithm>

#include "error_report.h"
#include "model_handle.h"
#include "pleat/base/status.h"
#include "pleat/character/joint_confidence.h"
#include "pose_argument.h"

namespace pleat {
namespace {

absl::Status CheckRoom(absl::string_view name, size_t num_values, size_t wanted) {
  if (num_values == wanted) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat("there are ", wanted, " values of ", name,
                                                 " and room for ", num_values,
                                                 ": ask pleat_model_get_info"));
}

absl::Status CopyRestPositions(const CharacterModel& character, float* positions,
                               size_t num_values) {
  const Eigen::Matrix3Xd& rest = character.rig().rest_positions;
  PLEAT_RETURN_IF_ERROR(CheckRoom("rest positions", num_values, static_cast<size_t>(rest.size())));
  if (positions == nullptr) return IsNull("positions");
  Eigen::Map<Eigen::Matrix3Xf>(positions, 3, rest.cols()) = rest.cast<float>();
  return absl::OkStatus();
}

absl::Status CopyInfluences(const CharacterModel& character, uint32_t per_vertex, uint32_t* bones,
                            float* weights, size_t num_values) {
  if (per_vertex < 1 || per_vertex > kMaxInfluences) {
    return absl::InvalidArgumentError(
        absl::StrCat("per_vertex is ", per_vertex, "; it is 1 to ", kMaxInfluences));
  }
  const SkinWeights& skin = character.rig().weights;
  const auto num_vertices = static_cast<size_t>(skin.num_vertices());
  PLEAT_RETURN_IF_ERROR(CheckRoom("influences", num_values, num_vertices * per_vertex));
  if (bones == nullptr) return IsNull("bones");
  if (weights == nullptr) return IsNull("weights");
  for (size_t v = 0; v < num_vertices; ++v) {
    const VertexInfluences& influences = skin.influences()[v];
    float sum = 0;  // falling and together 1, so the first is above 0
    for (uint32_t i = 0; i < per_vertex; ++i) sum += influences.weights[i];
    for (uint32_t i = 0; i < per_vertex; ++i) {
      const bool used = influences.weights[i] > 0;
      bones[v * per_vertex + i] = used ? influences.bones[i] : 0;
      weights[v * per_vertex + i] = influences.weights[i] / sum;
    }
  }
  return absl::OkStatus();
}

pleat_errors ShowErrors(const ErrorSummary& errors) {
  return {.mean_percent = errors.mean_percent,
          .rms_percent = errors.rms_percent,
          .p95_percent = errors.p95_percent,
          .max_percent = errors.max_percent,
          .mean_mm = errors.mean_mm};
}

absl::Status FillRecord(const CharacterModel& character, pleat_model_record* shown) {
  if (shown == nullptr) return IsNull("record");
  PLEAT_RETURN_IF_ERROR(
      CheckStructSize("pleat_model_record", shown->struct_size, sizeof(pleat_model_record)));
  const TrainingRecord& record = character.record();
  shown->learner = record.learner.c_str();
  shown->num_frames = static_cast<uint32_t>(record.num_frames);
  shown->num_warnings = static_cast<uint32_t>(record.warnings.size());
  shown->rig_residual = record.rig_residual;
  shown->diagonal_m = record.diagonal_m;
  shown->skinned = ShowErrors(record.fit);
  shown->detailed = ShowErrors(record.reconstruction);
  return absl::OkStatus();
}

absl::Status FillJointConfidence(const CharacterModel& character, const pleat_pose* poses,
                                 size_t num_poses, double* confidence, size_t num_joints) {
  if (num_poses == 0) return absl::InvalidArgumentError("a query needs at least one pose");
  if (poses == nullptr) return IsNull("poses");
  if (confidence == nullptr) return IsNull("confidence");
  PLEAT_RETURN_IF_ERROR(
      CheckRoom("confidence", num_joints, static_cast<size_t>(character.skeleton().num_joints())));
  const size_t looked_at = std::min(num_poses, static_cast<size_t>(character.options().history));
  std::vector<Pose> taken(looked_at);
  std::vector<const Pose*> pointers;
  for (size_t h = 0; h < looked_at; ++h) {
    PLEAT_RETURN_IF_ERROR(TakePose(poses[h], character.skeleton().num_joints(), &taken[h]));
    pointers.push_back(&taken[h]);
  }
  std::vector<double> found;
  PLEAT_RETURN_IF_ERROR(JointConfidence(character, pointers, &found));
  std::copy(found.begin(), found.end(), confidence);
  return absl::OkStatus();
}

// Runs `call` on the character of a model that is there.
template <typename Call>
pleat_code OfCharacter(const pleat_model* model, pleat_error* error, Call&& call) noexcept {
  return Guarded(error, [&]() -> absl::Status {
    if (model == nullptr) return IsNull("model");
    return call(*model->character);
  });
}

}  // namespace
}  // namespace pleat

using pleat::OfCharacter;

extern "C" {

pleat_code pleat_model_copy_rest_positions(const pleat_model* model, float* positions,
                                           size_t num_values, pleat_error* error) {
  return OfCharacter(model, error, [&](const auto& character) {
    return pleat::CopyRestPositions(character, positions, num_values);
  });
}

pleat_code pleat_model_copy_influences(const pleat_model* model, uint32_t per_vertex,
                                       uint32_t* bones, float* weights, size_t num_values,
                                       pleat_error* error) {
  return OfCharacter(model, error, [&](const auto& character) {
    return pleat::CopyInfluences(character, per_vertex, bones, weights, num_values);
  });
}

pleat_code pleat_model_get_record(const pleat_model* model, pleat_model_record* record,
                                  pleat_error* error) {
  return OfCharacter(model, error,
                     [&](const auto& character) { return pleat::FillRecord(character, record); });
}

const char* pleat_model_warning(const pleat_model* model, uint32_t warning) {
  if (model == nullptr) return nullptr;
  const auto& warnings = model->character->record().warnings;
  return warning < warnings.size() ? warnings[warning].c_str() : nullptr;
}

pleat_code pleat_joint_confidence(const pleat_model* model, const pleat_pose* poses,
                                  size_t num_poses, double* confidence, size_t num_joints,
                                  pleat_error* error) {
  return OfCharacter(model, error, [&](const auto& character) {
    return pleat::FillJointConfidence(character, poses, num_poses, confidence, num_joints);
  });
}

}  // extern "C"
