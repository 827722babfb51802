#include "pleat/character/character_model.h"

#include <algorithm>
#include <functional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "option_values.h"
#include "pleat/base/status.h"
#include "pleat/skinning/user_rig.h"

namespace pleat {
namespace {

absl::Status Mismatch(absl::string_view what, int64_t found, int64_t expected) {
  return absl::InvalidArgumentError(
      absl::StrCat("character model: ", what, " is ", found, ", expected ", expected));
}

absl::Status CheckControlVertices(const CharacterModel::Parts& parts, int num_vertices) {
  const std::vector<int>& control = parts.control_vertices;
  if (control.empty() || control.front() < 0 || control.back() >= num_vertices ||
      std::adjacent_find(control.begin(), control.end(), std::greater_equal<int>()) !=
          control.end()) {
    return absl::InvalidArgumentError(absl::StrCat(
        "character model: the control vertices are not ascending indices below ", num_vertices));
  }
  const int num_control = static_cast<int>(control.size());
  if (!parts.upsampler) {
    if (num_control == num_vertices) return absl::OkStatus();
    return Mismatch("the number of control vertices without an upsampler", num_control,
                    num_vertices);
  }
  if (parts.upsampler->matrix().rows() != num_vertices) {
    return Mismatch("the row count of the upsampler", parts.upsampler->matrix().rows(),
                    num_vertices);
  }
  if (parts.upsampler->matrix().cols() != num_control) {
    return Mismatch("the column count of the upsampler", parts.upsampler->matrix().cols(),
                    num_control);
  }
  return absl::OkStatus();
}

absl::Status CheckParts(const CharacterModel::Parts& parts) {
  PLEAT_RETURN_IF_ERROR(ValidateTrainOptions(parts.options));
  const int num_vertices = parts.topology.num_vertices();
  const int num_joints = parts.rig.skeleton.num_joints();
  if (num_joints < 2) return Mismatch("the number of joints", num_joints, 2);
  // Scratch memory of skinning is made for this many, and tables of pairs grow with the square.
  if (num_joints > kMaxUserJoints) {
    return absl::InvalidArgumentError(absl::StrCat("character model: the skeleton has ", num_joints,
                                                   " joints, the limit is ", kMaxUserJoints));
  }
  if (parts.rig.rest_positions.cols() != num_vertices) {
    return Mismatch("the number of rest positions", parts.rig.rest_positions.cols(), num_vertices);
  }
  if (!parts.rig.rest_positions.allFinite()) {
    return absl::InvalidArgumentError("character model: a rest position is not finite");
  }
  if (parts.rig.weights.num_vertices() != num_vertices) {
    return Mismatch("the number of weighted vertices", parts.rig.weights.num_vertices(),
                    num_vertices);
  }
  if (parts.rig.weights.num_joints() != num_joints) {
    return Mismatch("the number of joints of the weights", parts.rig.weights.num_joints(),
                    num_joints);
  }
  PLEAT_RETURN_IF_ERROR(CheckControlVertices(parts, num_vertices));
  const int values = NumCoordinates(parts.options.rotations);
  if (parts.feature_reference.size() != values * (num_joints - 1)) {
    return Mismatch("the size of the feature reference", parts.feature_reference.size(),
                    values * (num_joints - 1));
  }
  if (!parts.feature_reference.allFinite()) {
    return absl::InvalidArgumentError("character model: the feature reference is not finite");
  }
  if (!parts.detail_model) {
    return absl::InvalidArgumentError("character model: there is no detail model");
  }
  if (parts.detail_model->num_features() !=
      parts.feature_reference.size() * parts.options.history) {
    return Mismatch("the number of inputs of the detail model", parts.detail_model->num_features(),
                    parts.feature_reference.size() * parts.options.history);
  }
  if (parts.detail_model->num_details() != 3 * static_cast<int>(parts.control_vertices.size())) {
    return Mismatch("the number of outputs of the detail model", parts.detail_model->num_details(),
                    3 * static_cast<int64_t>(parts.control_vertices.size()));
  }
  return absl::OkStatus();
}

size_t DetailModelBytes(const DetailModel& detail) {
  size_t bytes = detail.basis().memory_bytes();
  for (const GpRegression& stage : detail.stages()) {
    const GpRegressionParameters& parameters = stage.parameters();
    bytes += static_cast<size_t>(parameters.inputs.size() + 2 * parameters.alpha.size()) *
                 sizeof(double) +
             static_cast<size_t>(parameters.whitener.size()) * sizeof(float);
  }
  if (detail.regional()) bytes += detail.regional()->memory_bytes();
  return bytes;
}

// Applies the V x C upsampling to each coordinate of every column of `control` (3C x r).
Eigen::MatrixXd UpsampleColumns(const RbfUpsampler& upsampler, const Eigen::MatrixXd& control) {
  const Eigen::Index num_vertices = upsampler.matrix().rows();
  Eigen::MatrixXd full(3 * num_vertices, control.cols());
  for (Eigen::Index column = 0; column < control.cols(); ++column) {
    const Eigen::MatrixXf xyz = control.col(column).cast<float>().reshaped(3, control.rows() / 3);
    const Eigen::MatrixXf upsampled = upsampler.matrix() * xyz.transpose();  // V x 3
    full.col(column) = upsampled.transpose().reshaped().cast<double>();
  }
  return full;
}

// Folds the upsampling into the basis. The result is quantized as finely as the basis of the
// control vertices was, component by component, so upsampling does not add a coarser rounding.
absl::StatusOr<DetailBasis> Upsample(const RbfUpsampler& upsampler, const DetailBasis& control) {
  const Eigen::VectorXd mean = control.Mean().cast<double>();
  return DetailBasis::Quantize(UpsampleColumns(upsampler, mean).cast<float>(),
                               UpsampleColumns(upsampler, control.Dense()), control.FinestSteps());
}

}  // namespace

absl::StatusOr<std::shared_ptr<const CharacterModel>> CharacterModel::Create(Parts parts) {
  PLEAT_RETURN_IF_ERROR(CheckParts(parts));
  PoseFeatures features(FeatureOptionsOf(parts.options), parts.rig.skeleton.num_joints(),
                        parts.feature_reference);
  DetailBasis upsampled_basis;
  if (parts.upsampler) {
    PLEAT_ASSIGN_OR_RETURN(upsampled_basis,
                           Upsample(*parts.upsampler, parts.detail_model->basis()));
  }
  return std::shared_ptr<const CharacterModel>(
      new CharacterModel(std::move(parts), std::move(features), std::move(upsampled_basis)));
}

CharacterModel::CharacterModel(Parts parts, PoseFeatures features, DetailBasis upsampled_basis)
    : parts_(std::move(parts)),
      features_(std::move(features)),
      skinning_(parts_.rig),
      upsampled_basis_(std::move(upsampled_basis)) {}

std::shared_ptr<const CharacterModel> CharacterModel::WithRecord(TrainingRecord record) const {
  const std::shared_ptr<CharacterModel> copy(new CharacterModel(*this));
  copy->parts_.record = std::move(record);
  return copy;
}

// Counts what grows with the mesh or with the training frames. Names, options and the record are
// small and left out.
size_t CharacterModel::memory_bytes() const {
  const size_t vertices = static_cast<size_t>(num_vertices());
  size_t bytes = sizeof(*this) + DetailModelBytes(*parts_.detail_model);
  bytes += vertices * (sizeof(VertexInfluences) + 3 * sizeof(double)) + skinning_.memory_bytes();
  bytes += static_cast<size_t>(parts_.topology.num_corners()) * sizeof(int32_t) +
           static_cast<size_t>(parts_.topology.num_faces()) * sizeof(int32_t) +
           static_cast<size_t>(parts_.topology.triangles().size()) * sizeof(int);
  bytes += parts_.appearance.texcoords.size() * sizeof(Eigen::Vector2f) +
           parts_.appearance.corner_texcoords.size() * sizeof(int32_t) +
           parts_.appearance.face_materials.size() * sizeof(int32_t);
  bytes += parts_.control_vertices.size() * sizeof(int);
  if (parts_.upsampler) {
    bytes +=
        static_cast<size_t>(parts_.upsampler->matrix().nonZeros()) * (sizeof(float) + sizeof(int));
  }
  bytes += upsampled_basis_.memory_bytes();
  return bytes;
}

}  // namespace pleat
