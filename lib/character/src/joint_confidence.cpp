#include "pleat/character/joint_confidence.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"
#include "pleat/gp/kernel.h"
#include "pleat/learner/detail_model.h"
#include "pleat/skeleton/pose_features.h"

namespace pleat {
namespace {

// Returns the features of `poses`, of which the oldest is repeated as often as the model needs.
absl::Status ComputeFeatures(const CharacterModel& model, const std::vector<const Pose*>& poses,
                             Eigen::VectorXd* row) {
  if (poses.empty()) return absl::InvalidArgumentError("a pose query needs at least one pose");
  const auto history = static_cast<size_t>(model.options().history);
  std::vector<Pose> normalized(history);
  std::vector<const Pose*> pointers;
  for (size_t h = 0; h < history; ++h) {
    const Pose& pose = *poses[std::min(h, poses.size() - 1)];
    PLEAT_RETURN_IF_ERROR(CheckJointCount(pose, model.skeleton().num_joints()));
    PLEAT_RETURN_IF_ERROR(CheckPose(pose));
    normalized[h] = pose;
    for (Eigen::Quaterniond& rotation : normalized[h].rotations) rotation.normalize();
    pointers.push_back(&normalized[h]);
  }
  row->resize(model.features().num_features());
  model.features().ComputeRow(pointers, *row);
  return absl::OkStatus();
}

}  // namespace

absl::Status JointConfidence(const CharacterModel& model, const std::vector<const Pose*>& poses,
                             std::vector<double>* confidence) {
  Eigen::VectorXd row;
  PLEAT_RETURN_IF_ERROR(ComputeFeatures(model, poses, &row));
  const GpRegressionParameters& stage = model.detail_model().stages().front().parameters();
  const int num_joints = model.skeleton().num_joints();
  const int num_coordinates = NumCoordinates(model.options().rotations);
  const int num_values = (num_joints - 1) * num_coordinates;  // of one pose
  if (stage.input_mean.size() != row.size() || stage.inputs.rows() == 0) {
    return absl::InternalError(absl::StrCat("the learner has ", stage.inputs.rows(), " rows of ",
                                            stage.input_mean.size(), " features, and a pose has ",
                                            row.size()));
  }
  row = (row - stage.input_mean).cwiseQuotient(stage.input_scales);
  const double inverse_width = KernelValuesOf(stage.kernel_options, stage.kernel).g;
  confidence->assign(static_cast<size_t>(num_joints), 1);
  Eigen::VectorXd squares(stage.inputs.rows());
  for (int j = 1; j < num_joints; ++j) {
    squares.setZero();
    for (int first = (j - 1) * num_coordinates; first < row.size(); first += num_values) {
      for (int d = first; d < first + num_coordinates; ++d) {
        squares.array() += (stage.inputs.col(d).array() - row[d]).square();
      }
    }
    (*confidence)[static_cast<size_t>(j)] = std::exp(-inverse_width / 2 * squares.minCoeff());
  }
  return absl::OkStatus();
}

}  // namespace pleat
