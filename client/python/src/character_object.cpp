#include "character_object.h"

#include <pybind11/stl.h>

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"
#include "python_error.h"

namespace py = pybind11;

namespace pleat {
namespace {

// The poses of N queries, H of each, as the evaluator wants them.
struct Queries {
  std::vector<Pose> poses;                         // N H
  std::vector<std::vector<const Pose*>> pointers;  // N
};

Queries TakeQueries(const TakenArray<double>& root_positions, const TakenArray<double>& rotations,
                    int num_joints) {
  CheckShape(rotations, {-1, -1, num_joints, 4}, "rotations");
  const py::ssize_t num_queries = rotations.shape(0), history = rotations.shape(1);
  CheckShape(root_positions, {num_queries, history, 3}, "root_positions");
  Queries queries;
  queries.poses =
      TakePoses(TakenArray<double>(root_positions).reshape({num_queries * history, py::ssize_t{3}}),
                TakenArray<double>(rotations).reshape(
                    {num_queries * history, static_cast<py::ssize_t>(num_joints), py::ssize_t{4}}));
  const Pose* next = queries.poses.data();
  for (py::ssize_t q = 0; q < num_queries; ++q) {
    queries.pointers.emplace_back();
    for (py::ssize_t h = 0; h < history; ++h) queries.pointers.back().push_back(next++);
  }
  return queries;
}

// The first error, with the number of its query.
absl::Status FirstError(const std::vector<PoseQuery>& queries) {
  for (size_t q = 0; q < queries.size(); ++q) {
    PLEAT_RETURN_IF_ERROR(WithContext(absl::StrCat("query ", q), queries[q].status));
  }
  return absl::OkStatus();
}

}  // namespace

// An evaluator that nobody else uses, for the time of a call.
class CharacterObject::Borrowed {
 public:
  explicit Borrowed(const CharacterObject& character) : lender_(character.lender_) {
    {
      const std::lock_guard lock(lender_->mutex);
      if (!lender_->idle.empty()) {
        evaluator_ = std::move(lender_->idle.back());
        lender_->idle.pop_back();
      }
    }
    if (!evaluator_) evaluator_ = std::make_unique<PoseEvaluator>(character.model_);
  }
  ~Borrowed() {
    const std::lock_guard lock(lender_->mutex);
    lender_->idle.push_back(std::move(evaluator_));
  }
  Borrowed(const Borrowed&) = delete;
  Borrowed& operator=(const Borrowed&) = delete;
  PoseEvaluator* operator->() { return evaluator_.get(); }

 private:
  std::shared_ptr<Lender> lender_;
  std::unique_ptr<PoseEvaluator> evaluator_;
};

CharacterObject::CharacterObject(std::shared_ptr<const CharacterModel> model)
    : model_(std::move(model)), lender_(std::make_shared<Lender>()) {}

std::vector<std::string> CharacterObject::joint_names() const {
  std::vector<std::string> names;
  for (const Joint& joint : model_->skeleton().joints()) names.push_back(joint.name);
  return names;
}

std::vector<int> CharacterObject::parents() const {
  std::vector<int> parents;
  for (const Joint& joint : model_->skeleton().joints()) parents.push_back(joint.parent);
  return parents;
}

py::array_t<double> CharacterObject::joint_positions() const {
  const Eigen::Matrix3Xd positions = model_->skeleton().RestPositions();
  auto array = NewArray<double>({positions.cols(), 3});
  std::copy_n(positions.data(), positions.size(), array.mutable_data());
  return array;
}

py::array_t<int32_t> CharacterObject::triangles() const {
  const Eigen::Matrix3Xi& triangles = model_->topology().triangles();
  auto array = NewArray<int32_t>({triangles.cols(), 3});
  std::copy_n(triangles.data(), triangles.size(), array.mutable_data());
  return array;
}

std::vector<VertexRows> CharacterObject::RowsOfFrames(py::array_t<float>* array) const {
  std::vector<VertexRows> rows;
  for (py::ssize_t n = 0; n < array->shape(0); ++n) {
    rows.push_back({.data = array->mutable_data() + n * 3 * num_vertices()});
  }
  return rows;
}

py::tuple CharacterObject::EvaluateMotion(const PoseTrack& motion,
                                          const std::vector<double>& bone_scales, bool skinned_only,
                                          const py::object& out, const py::object& progress) {
  const int num_frames = motion.num_frames();
  py::array_t<float> positions = TakeOut(out, {num_frames, num_vertices(), 3});
  const std::vector<VertexRows> rows = RowsOfFrames(&positions);
  auto confidence = NewArray<double>({num_frames});
  double* const confidences = confidence.mutable_data();
  PythonProgress report(progress);
  absl::Status status;
  {
    const py::gil_scoped_release unlock;
    Borrowed evaluator(*this);
    if (skinned_only) {
      const auto copy = [&](int t, const EvaluatedFrame& frame) {
        std::copy_n(frame.positions.data(), frame.positions.size(), rows[t].data);
        confidences[t] = frame.confidence;
        return absl::OkStatus();
      };
      status = CheckJointCount(motion, num_joints());
      if (status.ok()) {
        status = evaluator->EvaluateSkinnedClip(motion, bone_scales, copy, report.token());
      }
    } else {
      const auto keep = [&](int t, const EvaluatedFrame& frame) {
        confidences[t] = frame.confidence;
        return absl::OkStatus();
      };
      status = evaluator->EvaluateClip(motion, bone_scales, keep, report.token(), rows);
    }
  }
  report.Check();
  ThrowIfError(status);
  return py::make_tuple(std::move(positions), std::move(confidence));
}

py::tuple CharacterObject::EvaluatePoses(const TakenArray<double>& root_positions,
                                         const TakenArray<double>& rotations,
                                         const std::vector<double>& bone_scales, bool skinned_only,
                                         const py::object& out) {
  const Queries taken = TakeQueries(root_positions, rotations, num_joints());
  const auto num_queries = static_cast<py::ssize_t>(taken.pointers.size());
  py::array_t<float> positions = TakeOut(out, {num_queries, num_vertices(), 3});
  const std::vector<VertexRows> rows = RowsOfFrames(&positions);
  std::vector<EvaluatedFrame> frames(taken.pointers.size());
  std::vector<PoseQuery> queries(taken.pointers.size());
  for (size_t q = 0; q < queries.size(); ++q) {
    queries[q] = {.poses = &taken.pointers[q],
                  .bone_scales = &bone_scales,
                  .skinned_only = skinned_only,
                  .frame = &frames[q],
                  .rows = rows[q]};
  }
  {
    const py::gil_scoped_release unlock;
    Borrowed evaluator(*this);
    evaluator->EvaluateBatch(queries);
  }
  ThrowIfError(FirstError(queries));
  auto confidence = NewArray<double>({num_queries});
  for (size_t q = 0; q < frames.size(); ++q) confidence.mutable_data()[q] = frames[q].confidence;
  return py::make_tuple(std::move(positions), std::move(confidence));
}

py::tuple CharacterObject::Predict(const TakenArray<double>& root_positions,
                                   const TakenArray<double>& rotations, bool skinned_only) {
  const Queries taken = TakeQueries(root_positions, rotations, num_joints());
  std::vector<FrameParameters> parameters(taken.pointers.size());
  std::vector<PoseQuery> queries(taken.pointers.size());
  for (size_t q = 0; q < queries.size(); ++q) {
    queries[q] = {
        .poses = &taken.pointers[q], .skinned_only = skinned_only, .parameters = &parameters[q]};
  }
  {
    const py::gil_scoped_release unlock;
    Borrowed evaluator(*this);
    evaluator->EvaluateBatch(queries);
  }
  ThrowIfError(FirstError(queries));
  const auto num_queries = static_cast<py::ssize_t>(queries.size());
  const py::ssize_t num_values = skinned_only ? 0 : num_coefficients();
  auto roots = NewArray<double>({num_queries, 3});
  auto turns = NewArray<float>({num_queries, num_joints(), 4});
  auto coefficients = NewArray<float>({num_queries, num_values});
  auto confidence = NewArray<double>({num_queries});
  double* root = roots.mutable_data();
  float *turn = turns.mutable_data(), *values = coefficients.mutable_data();
  for (size_t q = 0; q < parameters.size(); ++q) {
    const FrameParameters& found = parameters[q];
    root = std::copy_n(found.pose.root_position.data(), 3, root);
    for (const Eigen::Quaterniond& rotation : found.pose.rotations) {
      const Eigen::Vector4f rounded = rotation.coeffs().cast<float>();
      turn = std::copy_n(rounded.data(), 4, turn);
    }
    values = std::copy_n(found.coefficients.data(), found.coefficients.size(), values);
    confidence.mutable_data()[q] = found.confidence;
  }
  return py::make_tuple(std::move(roots), std::move(turns), std::move(coefficients),
                        std::move(confidence));
}

py::array_t<float> CharacterObject::Show(const TakenArray<double>& root_positions,
                                         const TakenArray<float>& rotations,
                                         const TakenArray<float>& coefficients,
                                         const std::vector<double>& bone_scales,
                                         const py::object& out) {
  CheckShape(rotations, {-1, num_joints(), 4}, "rotations");
  const py::ssize_t num_frames = rotations.shape(0);
  CheckShape(root_positions, {num_frames, 3}, "root_positions");
  CheckShape(coefficients, {num_frames, -1}, "coefficients");
  py::array_t<float> positions = TakeOut(out, {num_frames, num_vertices(), 3});
  const std::vector<VertexRows> rows = RowsOfFrames(&positions);
  std::vector<FrameParameters> parameters(static_cast<size_t>(num_frames));
  for (size_t n = 0; n < parameters.size(); ++n) {
    const auto row = static_cast<py::ssize_t>(n);
    FrameParameters& frame = parameters[n];
    frame.pose.root_position = Eigen::Map<const Eigen::Vector3d>(root_positions.data(row));
    for (int j = 0; j < num_joints(); ++j) {
      frame.pose.rotations.emplace_back(
          Eigen::Map<const Eigen::Vector4f>(rotations.data(row, j)).cast<double>());
    }
    frame.coefficients =
        Eigen::Map<const Eigen::VectorXf>(coefficients.data(row), coefficients.shape(1));
  }
  absl::Status status;
  {
    const py::gil_scoped_release unlock;
    Borrowed evaluator(*this);
    EvaluatedFrame unused;
    for (size_t n = 0; n < parameters.size() && status.ok(); ++n) {
      status = WithContext(absl::StrCat("frame ", n),
                           evaluator->Show(parameters[n], bone_scales, &unused, rows[n]));
    }
  }
  ThrowIfError(status);
  return positions;
}

}  // namespace pleat
