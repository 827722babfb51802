// Y_S: poses as rows of a plain matrix, the input of every learner (paper, section IV-B).
#pragma once

#include <Eigen/Core>

#include "pleat/skeleton/pose_track.h"

namespace pleat {

enum class RotationRepresentation { kExponentialMap, kEuler, kQuaternion };

// How the predecessors of a pose stand in its row; the same information either way.
enum class HistoryForm {
  kDifferences,  // to the pose after them: a distance between rows weighs speed by itself
  kPoses,        // as they are (paper)
};

struct PoseFeatureOptions {
  // The paper's choice; Euler angles and quaternions were worse there, kept for the comparison.
  RotationRepresentation representation = RotationRepresentation::kExponentialMap;
  int history = 2;  // frames per row: the pose and its predecessors (paper: 2)
  HistoryForm history_form = HistoryForm::kDifferences;
};

// Coordinates of one rotation: 3, or 4 of a quaternion.
constexpr int NumCoordinates(RotationRepresentation representation) {
  return representation == RotationRepresentation::kQuaternion ? 4 : 3;
}

// Turns poses into feature rows without the root (independent of place and facing). Rotations
// are kept on the branch (2 pi wraps, quaternion sign) nearest to `reference`, which training sets
// to the track's mean, so a single query lands where training frames of the same pose lie.
class PoseFeatures {
 public:
  // reference: (J-1)*k values (k = 3, or 4 for quaternions), e.g. from Reference().
  PoseFeatures(PoseFeatureOptions options, int num_joints, Eigen::VectorXd reference);

  // The reference for a training track: the mean of its rotations, unwrapped along time.
  static Eigen::VectorXd Reference(const PoseFeatureOptions& options, const PoseTrack& track);

  int num_features() const { return static_cast<int>(reference_.size()) * options_.history; }
  const PoseFeatureOptions& options() const { return options_; }
  const Eigen::VectorXd& reference() const { return reference_; }

  // Writes one row: poses[0] is the current pose, poses[h] the pose h frames before.
  // `row` has num_features() entries: current pose first, then its predecessors (or differences).
  // No allocation.
  void ComputeRow(const std::vector<const Pose*>& poses, Eigen::Ref<Eigen::VectorXd> row) const;

  // T x num_features. Before a clip's first frame its first motion continues backwards
  // (PoseHistory), so that the first rows are not mistaken for standing still.
  Eigen::MatrixXd ComputeTrack(const PoseTrack& track) const;

 private:
  PoseFeatureOptions options_;
  Eigen::VectorXd reference_;
};

}  // namespace pleat
