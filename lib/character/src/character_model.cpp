#include "pleat/character/character_model.h"

#include <algorithm>
#include <functional>
#include <map>
#include <set>
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
  const Eigen::Index num_pose_features = parts.feature_reference.size() * parts.options.history;
  if (parts.detail_model->num_pose_features() != num_pose_features) {
    return Mismatch("the number of inputs of the detail model",
                    parts.detail_model->num_pose_features(), num_pose_features);
  }
  const int num_skin_features = parts.skin_features ? parts.skin_features->num_features() : 0;
  if (parts.detail_model->num_features() != num_pose_features + num_skin_features) {
    return Mismatch("the number of features of the skin",
                    parts.detail_model->num_features() - num_pose_features, num_skin_features);
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
  if (detail.fold()) bytes += detail.fold()->memory_bytes();
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

// Folds the upsampling into a basis of one part. The result is quantized as finely as the basis of
// the control vertices was, component by component, so upsampling does not add a coarser rounding.
absl::StatusOr<PartedBasis> UpsampleWhole(const RbfUpsampler& upsampler,
                                          const DetailBasisParameters& parameters) {
  PLEAT_ASSIGN_OR_RETURN(const DetailBasis control, DetailBasis::FromParameters(parameters));
  const Eigen::VectorXd mean = control.Mean().cast<double>();
  PLEAT_ASSIGN_OR_RETURN(
      const DetailBasis full,
      DetailBasis::Quantize(UpsampleColumns(upsampler, mean).cast<float>(),
                            UpsampleColumns(upsampler, control.Dense()), control.FinestSteps()));
  return PartedBasis::FromParameters(PartedBasisParameters::Whole(full.parameters()));
}

// The parts of the control vertices that each vertex is interpolated from, ascending.
std::vector<std::vector<int>> PartsOfVertices(const RbfUpsampler& upsampler,
                                              const PartedBasisParameters& control) {
  std::vector<int> part_of(static_cast<size_t>(upsampler.matrix().cols()));
  for (size_t p = 0; p < control.parts.size(); ++p) {
    for (const int c : control.parts[p].vertices) part_of[c] = static_cast<int>(p);
  }
  std::vector<std::vector<int>> parts(static_cast<size_t>(upsampler.matrix().rows()));
  for (Eigen::Index v = 0; v < upsampler.matrix().rows(); ++v) {
    std::set<int> own;
    for (RbfUpsampler::Matrix::InnerIterator entry(upsampler.matrix(), v); entry; ++entry) {
      own.insert(part_of[entry.col()]);
    }
    if (own.empty()) own.insert(0);  // a vertex that does not move
    parts[v].assign(own.begin(), own.end());
  }
  return parts;
}

// Folds the upsampling into a basis of several parts. A vertex between parts is moved by the
// components of all of them, so vertices of the same parts become one.
absl::StatusOr<PartedBasis> UpsampleParts(const RbfUpsampler& upsampler,
                                          const PartedBasis& control) {
  const PartedBasisParameters p = control.parameters();
  std::map<std::vector<int>, std::vector<int>> vertices_of_parts;
  const std::vector<std::vector<int>> parts_of = PartsOfVertices(upsampler, p);
  for (size_t v = 0; v < parts_of.size(); ++v) {
    vertices_of_parts[parts_of[v]].push_back(static_cast<int>(v));
  }
  Eigen::VectorXd steps(control.num_coefficients());
  for (const PartedBasisParameters::Part& part : p.parts) {
    PLEAT_ASSIGN_OR_RETURN(const DetailBasis basis, DetailBasis::FromParameters(part.basis));
    steps(part.coefficients) = basis.FinestSteps();
  }
  const Eigen::MatrixXd dense = control.Dense();
  const Eigen::VectorXf mean =
      UpsampleColumns(upsampler, control.Mean().cast<double>()).cast<float>();
  PartedBasisParameters full;
  full.num_coefficients = control.num_coefficients();
  for (const auto& [parts, vertices] : vertices_of_parts) {
    PartedBasisParameters::Part part{vertices, {}, {}};
    for (const int number : parts) {
      const std::vector<int>& coefficients = p.parts[number].coefficients;
      part.coefficients.insert(part.coefficients.end(), coefficients.begin(), coefficients.end());
    }
    std::vector<int> rows;
    for (const int v : vertices) rows.insert(rows.end(), {3 * v, 3 * v + 1, 3 * v + 2});
    const Eigen::MatrixXd columns =
        UpsampleColumns(upsampler, dense(Eigen::all, part.coefficients));
    PLEAT_ASSIGN_OR_RETURN(
        const DetailBasis basis,
        DetailBasis::Quantize(mean(rows), columns(rows, Eigen::all), steps(part.coefficients)));
    part.basis = basis.parameters();
    full.parts.push_back(std::move(part));
  }
  return PartedBasis::FromParameters(full);
}

absl::StatusOr<PartedBasis> Upsample(const RbfUpsampler& upsampler, const PartedBasis& control) {
  const PartedBasisParameters p = control.parameters();
  const bool whole = p.parts.size() == 1 && p.parts[0].vertices.empty();
  return whole ? UpsampleWhole(upsampler, p.parts[0].basis) : UpsampleParts(upsampler, control);
}

}  // namespace

absl::StatusOr<std::shared_ptr<const CharacterModel>> CharacterModel::Create(Parts parts) {
  PLEAT_RETURN_IF_ERROR(CheckParts(parts));
  PoseFeatures features(FeatureOptionsOf(parts.options), parts.rig.skeleton.num_joints(),
                        parts.feature_reference);
  PartedBasis upsampled_basis;
  if (parts.upsampler) {
    PLEAT_ASSIGN_OR_RETURN(upsampled_basis,
                           Upsample(*parts.upsampler, parts.detail_model->basis()));
  }
  return std::shared_ptr<const CharacterModel>(
      new CharacterModel(std::move(parts), std::move(features), std::move(upsampled_basis)));
}

CharacterModel::CharacterModel(Parts parts, PoseFeatures features, PartedBasis upsampled_basis)
    : parts_(std::move(parts)),
      features_(std::move(features)),
      upsampled_basis_(std::move(upsampled_basis)) {
  skinning_ = FrameSkinning(parts_.rig, full_basis().LaneVertices());
}

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
  if (parts_.skin_features) bytes += parts_.skin_features->memory_bytes();
  return bytes;
}

}  // namespace pleat
