// Poses as the rows of a plain matrix, which is the input Y_S of every learner (paper, section
// IV-B).
#pragma once

#include <Eigen/Core>

#include "pleat/skeleton/pose_track.h"

namespace pleat {

enum class RotationRepresentation { kExponentialMap, kEuler, kQuaternion };

// How the predecessors of a pose stand in its row. The information is the same either way.
enum class HistoryForm {
  kDifferences,  // as differences from the pose after them, so distances between rows weigh speed
  kPoses,        // as they are (the paper's choice)
};

struct PoseFeatureOptions {
  // The paper's choice. Euler angles and quaternions were worse there and are kept for comparison.
  RotationRepresentation representation = RotationRepresentation::kExponentialMap;
  int history = 2;  // poses per row: the current one and its predecessors (paper: 2)
  HistoryForm history_form = HistoryForm::kDifferences;
};

// Returns the number of coordinates of one rotation: 4 for a quaternion, otherwise 3.
constexpr int NumCoordinates(RotationRepresentation representation) {
  return representation == RotationRepresentation::kQuaternion ? 4 : 3;
}

// Turns poses into feature rows. The root is left out, so features depend neither on place nor on
// facing. Coordinates of a rotation are ambiguous by turns of 2 pi or by the sign of the
// quaternion; they are taken from the branch that is nearest to `reference`. Training sets the
// reference to the mean of its track, so a single query lands where training frames of the same
// pose lie. Immutable; threads may share it.
class PoseFeatures {
 public:
  // reference: (J - 1) k values with k = NumCoordinates, such as those of Reference().
  PoseFeatures(PoseFeatureOptions options, int num_joints, Eigen::VectorXd reference);

  // Returns the reference for a training track: the mean of its rotations, unwrapped along time.
  // The track must have frames (asserted).
  static Eigen::VectorXd Reference(const PoseFeatureOptions& options, const PoseTrack& track);

  int num_features() const { return static_cast<int>(reference_.size()) * options_.history; }
  const PoseFeatureOptions& options() const { return options_; }
  const Eigen::VectorXd& reference() const { return reference_; }

  // Writes one row without an allocation. poses[0] is the current pose, poses[h] the pose h
  // intervals before it; there must be options().history of them. `row` has num_features() entries:
  // those of the current pose come first, then those of its predecessors, or the differences.
  void ComputeRow(const std::vector<const Pose*>& poses, Eigen::Ref<Eigen::VectorXd> row) const;

  // Returns the rows of all frames, T x num_features. Before the first frame of a clip its first
  // motion continues backwards (PoseHistory), so that the first rows do not look like standing
  // still.
  Eigen::MatrixXd ComputeTrack(const PoseTrack& track) const;

 private:
  PoseFeatureOptions options_;
  Eigen::VectorXd reference_;
};

}  // namespace pleat
