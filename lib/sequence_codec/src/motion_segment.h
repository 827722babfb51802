// The low-rank motion of some consecutive frames:
//   x_t(v) = R_t (rest(v) + sum_k w_k(t) field_k(v)) + c_t.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "binary_coder.h"
#include "pleat/geometry/surface_hierarchy.h"
#include "trajectory_coder.h"

namespace pleat {

// Frames are evaluated, and can be read at random, in groups of this many.
inline constexpr int kGroupFrames = 16;

// Steps of quantization, all derived from one by the encoder so that a bit buys the same
// everywhere.
struct MotionSteps {
  float field_m = 0;        // of the fields' coefficients and of the trajectories
  float rest_m = 0;         // of the rest shape
  float rotation = 0;       // of the quaternions' cosine coefficients
  float translation_m = 0;  // of the centers' cosine coefficients
};

struct MotionSegment {
  int first_frame = 0, num_frames = 0, num_components = 0;
  std::vector<Eigen::Matrix3f> rotations;     // per frame
  std::vector<Eigen::Vector3f> translations;  // per frame, meters
  // K x T rounded up to whole groups, row-major: w_k(t).
  Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> weights;
  FieldMatrix fields;  // V x 3 K, meters

  int num_groups() const { return (num_frames + kGroupFrames - 1) / kGroupFrames; }
};

// Rows 0 .. 3: quaternions w, x, y, z (any length), rows 4 .. 6: centers. Encoding reads and both
// directions leave the decoded values there and in `segment`, whose num_frames must be set.
absl::Status CodeRigidMotion(const MotionSteps& steps, BinaryCoder* coder, TrajectoryMatrix* rigid,
                             MotionSegment* segment);

// rows: K x T, trajectory times importance. Encoding reads them; both directions leave unit rows
// there and in `segment` (num_frames and num_components set).
absl::Status CodeWeights(const MotionSteps& steps, BinaryCoder* coder, TrajectoryMatrix* rows,
                         MotionSegment* segment);

// The frames of group `group` into `frames` (resized to 3 x V each). rest: 3 x V, meters. The same
// bits on every machine: every coordinate is one sum in the order of k, without contraction.
void EvaluateGroup(const Eigen::Matrix3Xf& rest, const MotionSegment& segment, int group,
                   std::vector<Eigen::Matrix3Xf>* frames);

}  // namespace pleat
