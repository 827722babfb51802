#include "pleat/skeleton/pose_features.h"

#include <cassert>
#include <cmath>
#include <numbers>
#include <utility>

#include "pleat/math/rotations.h"
#include "pleat/skeleton/pose_history.h"

namespace pleat {
namespace {

// Writes the coordinates of `rotation` (3 or 4 values) on the branch nearest to `reference`.
void ToCoordinates(RotationRepresentation representation, const Eigen::Quaterniond& rotation,
                   const Eigen::Ref<const Eigen::VectorXd>& reference,
                   Eigen::Ref<Eigen::VectorXd> out) {
  switch (representation) {
    case RotationRepresentation::kExponentialMap:
      out = UnwrapExponentialMap(ExponentialMapFromQuaternion(rotation), reference);
      return;
    case RotationRepresentation::kEuler: {
      const Eigen::Vector3d angles = EulerXyzFromRotation(rotation.toRotationMatrix());
      for (int i = 0; i < 3; ++i) {
        const double turns = std::round((reference[i] - angles[i]) / (2 * std::numbers::pi));
        out[i] = angles[i] + 2 * std::numbers::pi * turns;
      }
      return;
    }
    case RotationRepresentation::kQuaternion: {
      Eigen::Vector4d q(rotation.w(), rotation.x(), rotation.y(), rotation.z());
      out = reference.dot(q) < 0 ? Eigen::Vector4d(-q) : q;
      return;
    }
  }
}

// Returns a reference that any rotation may be compared with before a track is known: no rotation.
Eigen::VectorXd NeutralReference(RotationRepresentation representation, int num_joints) {
  const int k = NumCoordinates(representation);
  Eigen::VectorXd reference = Eigen::VectorXd::Zero((num_joints - 1) * k);
  if (k == 4) {
    for (int j = 0; j + 1 < num_joints; ++j) reference[4 * j] = 1;
  }
  return reference;
}

}  // namespace

PoseFeatures::PoseFeatures(PoseFeatureOptions options, int num_joints, Eigen::VectorXd reference)
    : options_(options), reference_(std::move(reference)) {
  assert(reference_.size() == (num_joints - 1) * NumCoordinates(options.representation));
  (void)num_joints;
}

Eigen::VectorXd PoseFeatures::Reference(const PoseFeatureOptions& options, const PoseTrack& track) {
  assert(track.num_frames() > 0);
  const int num_joints = track.num_joints();
  const int k = NumCoordinates(options.representation);
  // The coordinates of each frame are taken on the branch nearest to those of the frame before, so
  // a rotation that passes 180 degrees goes on smoothly and the mean lies in the middle of the
  // motion.
  Eigen::VectorXd current = NeutralReference(options.representation, num_joints);
  const Eigen::VectorXd neutral = current;
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(current.size());
  for (int t = 0; t < track.num_frames(); ++t) {
    if (track.StartsClip(t)) current = neutral;  // a new clip starts on the neutral branch again
    for (int j = 1; j < num_joints; ++j) {
      const Eigen::VectorXd before = current.segment((j - 1) * k, k);
      ToCoordinates(options.representation, track.pose(t).rotations[j], before,
                    current.segment((j - 1) * k, k));
    }
    sum += current;
  }
  return sum / track.num_frames();
}

void PoseFeatures::ComputeRow(const std::vector<const Pose*>& poses,
                              Eigen::Ref<Eigen::VectorXd> row) const {
  assert(static_cast<int>(poses.size()) == options_.history && row.size() == num_features());
  const int k = NumCoordinates(options_.representation);
  const int block = static_cast<int>(reference_.size());
  for (int h = 0; h < options_.history; ++h) {
    for (int j = 0; j * k < block; ++j) {
      ToCoordinates(options_.representation, poses[h]->rotations[j + 1],
                    reference_.segment(j * k, k), row.segment(h * block + j * k, k));
    }
  }
  if (options_.history_form == HistoryForm::kPoses) return;
  // From the oldest on, because each pose still needs its successor as it is.
  for (int h = options_.history - 1; h > 0; --h) {
    row.segment(h * block, block) =
        row.segment((h - 1) * block, block) - row.segment(h * block, block);
  }
}

Eigen::MatrixXd PoseFeatures::ComputeTrack(const PoseTrack& track) const {
  Eigen::MatrixXd rows(track.num_frames(), num_features());
  Eigen::VectorXd row(num_features());
  PoseHistory history(track, track.fps(), options_.history);
  std::vector<const Pose*> poses;
  for (int t = 0; t < track.num_frames(); ++t) {
    history.At(t, &poses);
    ComputeRow(poses, row);
    rows.row(t) = row.transpose();
  }
  return rows;
}

}  // namespace pleat
