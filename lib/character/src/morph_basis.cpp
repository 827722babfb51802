#include "pleat/character/morph_basis.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "pleat/base/status.h"
#include "pleat/character/pose_evaluator.h"
#include "pleat/math/pca.h"
#include "pleat/math/spread_rows.h"

namespace pleat {
namespace {

// Where the bones of a vertex turn against each other, their blend flattens it, and the way back
// into the rest pose is damped.
constexpr double kFlat = .1, kDamping = 1e-3;  // of the determinant, which is 1 for a rotation
constexpr double kMaxBasisBytes = double{uint64_t{1} << 30};

// The linear part of the skinning of each vertex in a pose: what turns a difference at rest into
// one in the world.
std::vector<Eigen::Matrix3d> BlendedLinear(const SkinWeights& weights,
                                           const BoneTransforms& transforms) {
  std::vector<Eigen::Matrix3d> blended;
  blended.reserve(static_cast<size_t>(weights.num_vertices()));
  for (const VertexInfluences& vertex : weights.influences()) {
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (int k = 0; k < kMaxInfluences && vertex.weights[k] > 0; ++k) {
      sum += double{vertex.weights[k]} * transforms.linear[vertex.bones[k]];
    }
    blended.push_back(sum);
  }
  return blended;
}

Eigen::Vector3d Unturned(const Eigen::Matrix3d& linear, const Eigen::Vector3d& difference) {
  if (linear.determinant() > kFlat) return linear.inverse() * difference;
  const Eigen::Matrix3d normal =
      linear.transpose() * linear + kDamping * Eigen::Matrix3d::Identity();
  return normal.inverse() * (linear.transpose() * difference);
}

// 1, 2, 3, 4, 6, 8, 12, ... below `last`, then `last`.
std::vector<int> TriedCounts(int last) {
  std::vector<int> counts = {0};
  for (int power = 1; power < last; power *= 2) {
    counts.push_back(power);
    if (power > 1 && power * 3 / 2 < last) counts.push_back(power * 3 / 2);
  }
  counts.push_back(last);
  return counts;
}

class MorphBasisBuilder {
 public:
  MorphBasisBuilder(const std::shared_ptr<const CharacterModel>& model, const SkinWeights& weights,
                    const PoseTrack& track, const MorphBasisOptions& options)
      : model_(model), weights_(weights), track_(track), options_(options), evaluator_(model) {}

  absl::StatusOr<MorphBasis> Build(const Progress& progress) {
    PLEAT_RETURN_IF_ERROR(LearnBasis(progress.Stage("basis", 0, .5)));
    counts_ = TriedCounts(static_cast<int>(basis_.targets.cols()));
    PLEAT_RETURN_IF_ERROR(Project(progress.Stage("weights", .5, 1)));
    PLEAT_RETURN_IF_ERROR(Choose());
    Normalize();
    return std::move(basis_);
  }

 private:
  // The differences of frame t in the rest pose, 3V.
  Eigen::VectorXd RestDifferences(int t, const EvaluatedFrame& frame) {
    ComputeBoneTransforms(model_->skeleton(), track_.pose(t), {}, &transforms_);
    SkinVertices(weights_, model_->rig().rest_positions, transforms_, &skinned_);
    linear_ = BlendedLinear(weights_, transforms_);
    Eigen::VectorXd differences(3 * skinned_.cols());
    for (Eigen::Index v = 0; v < skinned_.cols(); ++v) {
      differences.segment<3>(3 * v) = Unturned(
          linear_[static_cast<size_t>(v)], frame.positions.col(v).cast<double>() - skinned_.col(v));
    }
    return differences;
  }

  absl::Status LearnBasis(const Progress& progress) {
    const int num_frames = track_.num_frames();
    const double row_bytes = 24. * model_->num_vertices();
    const int most = static_cast<int>(
        std::clamp(kMaxBasisBytes / row_bytes, 16., double(options_.max_basis_frames)));
    const std::vector<Eigen::Index> chosen = SpreadRows(num_frames, most);
    Eigen::MatrixXd data(static_cast<Eigen::Index>(chosen.size()), 3 * model_->num_vertices());
    Eigen::Index row = 0;
    PLEAT_RETURN_IF_ERROR(evaluator_.EvaluateClip(
        track_, {}, [&](int t, const EvaluatedFrame& frame) -> absl::Status {
          if (row < data.rows() && chosen[static_cast<size_t>(row)] == t) {
            data.row(row++) = RestDifferences(t, frame);
          }
          return progress.Report((t + 1.) / num_frames);
        }));
    const int wanted = options_.num_targets > 0 ? options_.num_targets : kMaxMorphTargets;
    const PrincipalComponents components =
        ComputePca(data, {.max_components = std::max(0, wanted - 1)});
    const Eigen::Index num_components = wanted == 1 ? 0 : components.basis.cols();
    orthonormal_ = components.basis.leftCols(num_components);
    basis_.targets.resize(data.cols(), 1 + num_components);
    basis_.targets.col(0) = components.mean.cast<float>();
    basis_.targets.rightCols(num_components) = orthonormal_.cast<float>();
    return absl::OkStatus();
  }

  // The weights of all frames, and the errors with so many targets as are tried.
  absl::Status Project(const Progress& progress) {
    const int num_frames = track_.num_frames();
    basis_.weights = Eigen::MatrixXf::Ones(num_frames, basis_.targets.cols());
    std::vector<double> squared(counts_.size(), 0), largest(counts_.size(), 0);
    const Eigen::MatrixXd targets = basis_.targets.cast<double>();
    PLEAT_RETURN_IF_ERROR(evaluator_.EvaluateClip(
        track_, {}, [&](int t, const EvaluatedFrame& frame) -> absl::Status {
          Eigen::VectorXd rest = RestDifferences(t, frame);
          if (orthonormal_.cols() > 0) {
            basis_.weights.row(t).tail(orthonormal_.cols()) =
                (orthonormal_.transpose() * (rest - targets.col(0))).cast<float>();
          }
          for (size_t c = 0; c < counts_.size(); ++c) {
            const int before = c == 0 ? 0 : counts_[c - 1], added = counts_[c] - before;
            rest.noalias() -=
                targets.middleCols(before, added) *
                basis_.weights.row(t).segment(before, added).cast<double>().transpose();
            AddErrors(frame, rest, &squared[c], &largest[c]);
          }
          return progress.Report((t + 1.) / num_frames);
        }));
    const double count = static_cast<double>(num_frames) * model_->num_vertices();
    for (size_t c = 0; c < counts_.size(); ++c) {
      basis_.errors.push_back({counts_[c], std::sqrt(squared[c] / count), std::sqrt(largest[c])});
    }
    return absl::OkStatus();
  }

  // `rest`: what the targets leave of the differences. Where a way back was damped, the skinned
  // vertex is off by what the damping took as well.
  void AddErrors(const EvaluatedFrame& frame, const Eigen::VectorXd& rest, double* squared,
                 double* largest) const {
    const auto num_vertices = static_cast<size_t>(skinned_.cols());
    for (size_t v = 0; v < num_vertices; ++v) {
      const auto column = static_cast<Eigen::Index>(v);
      double distance = 0;
      if (linear_[v].determinant() > kFlat) {
        distance = (linear_[v] * rest.segment<3>(3 * column)).squaredNorm();
      } else {
        const Eigen::Vector3d wanted =
            frame.positions.col(column).cast<double>() - skinned_.col(column);
        const Eigen::Vector3d shown = Unturned(linear_[v], wanted) - rest.segment<3>(3 * column);
        distance = (wanted - linear_[v] * shown).squaredNorm();
      }
      *squared += distance;
      *largest = std::max(*largest, distance);
    }
  }

  absl::Status Choose() {
    if (!(options_.max_error_m > 0)) return absl::OkStatus();
    const auto enough = std::ranges::find_if(basis_.errors, [&](const MorphBasisError& error) {
      return error.num_targets > 0 && error.max_m <= options_.max_error_m;
    });
    if (enough == basis_.errors.end()) {
      const MorphBasisError& last = basis_.errors.back();
      return absl::FailedPreconditionError(absl::StrFormat(
          "%d morph targets leave an error of %.3g mm (%.3g mm asked for); a clip of %d frames has "
          "no more, at most %d: ask for a larger error, or write the mesh of every frame",
          last.num_targets, 1000 * last.max_m, 1000 * options_.max_error_m, track_.num_frames(),
          kMaxMorphTargets));
    }
    const int count = enough->num_targets;
    basis_.errors.erase(enough + 1, basis_.errors.end());
    basis_.targets = basis_.targets.leftCols(count).eval();
    basis_.weights = basis_.weights.leftCols(count).eval();
    return absl::OkStatus();
  }

  // Programs cut weights at 0 and at 1. What lies below 0 goes into target 0, which always shows.
  void Normalize() {
    for (Eigen::Index k = 1; k < basis_.targets.cols(); ++k) {
      const float low = basis_.weights.col(k).minCoeff();
      const float range = basis_.weights.col(k).maxCoeff() - low;
      basis_.targets.col(0) += low * basis_.targets.col(k);
      basis_.weights.col(k).array() -= low;
      if (!(range > 0)) continue;
      basis_.targets.col(k) *= range;
      basis_.weights.col(k) /= range;
    }
  }

  const std::shared_ptr<const CharacterModel>& model_;
  const SkinWeights& weights_;
  const PoseTrack& track_;
  const MorphBasisOptions& options_;
  PoseEvaluator evaluator_;
  Eigen::MatrixXd orthonormal_;  // 3V x (N - 1)
  std::vector<int> counts_;      // numbers of targets whose errors are measured
  MorphBasis basis_;
  // These belong to the frame at hand.
  BoneTransforms transforms_;
  Eigen::Matrix3Xd skinned_;
  std::vector<Eigen::Matrix3d> linear_;
};

}  // namespace

absl::StatusOr<MorphBasis> ComputeMorphBasis(const std::shared_ptr<const CharacterModel>& model,
                                             const SkinWeights& weights, const PoseTrack& track,
                                             const MorphBasisOptions& options,
                                             const Progress& progress) {
  if (track.num_frames() == 0) {
    return absl::InvalidArgumentError("morph targets show the folds of a clip: give a motion");
  }
  PLEAT_RETURN_IF_ERROR(CheckJointCount(track, model->skeleton().num_joints()));
  if (weights.num_vertices() != model->num_vertices()) {
    return absl::InvalidArgumentError(absl::StrCat(
        "weights of ", weights.num_vertices(), " vertices; the model has ", model->num_vertices()));
  }
  const bool has_count = options.num_targets > 0 && options.num_targets <= kMaxMorphTargets;
  if (!has_count && !(options.num_targets == 0 && options.max_error_m > 0)) {
    return absl::InvalidArgumentError(
        absl::StrCat("ask for 1 to ", kMaxMorphTargets, " morph targets, or for a largest error"));
  }
  return MorphBasisBuilder(model, weights, track, options).Build(progress);
}

}  // namespace pleat
