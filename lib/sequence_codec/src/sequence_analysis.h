// What an encoder finds out about a sequence once, whatever the rate.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/base/progress.h"
#include "pleat/mesh/mesh_sequence.h"
#include "trajectory_coder.h"

namespace pleat {

// Frames [first_frame, first_frame + num_frames): x_t ~ R_t (rest + sum_k w_k(t) field_k) + c_t.
struct SegmentAnalysis {
  int first_frame = 0, num_frames = 0;
  TrajectoryMatrix rigid;  // 7 x T: quaternion w, x, y, z without jumps of sign, then the centroid
  // Principal trajectories of the motion relative to the rest shape: K x T unit rows by falling
  // `singular_values` (K, meters).
  TrajectoryMatrix trajectories;
  Eigen::VectorXd singular_values;
};

struct SequenceAnalysis {
  Eigen::Matrix3Xf rest;  // 3 x V: mean of the aligned frames, centered
  std::vector<SegmentAnalysis> segments;
};

// num_threads: 0 = one per core; the result does not depend on it. kCancelled.
absl::StatusOr<SequenceAnalysis> AnalyzeSequence(const MeshSequence& sequence, int num_threads,
                                                 const Progress& progress);

}  // namespace pleat
