// Named errors between two animations, as distances of corresponding vertices.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace pleat {

// A summary of errors. Percent values are shares of the bounding-box diagonal of the rest frame
// (docs/method/evaluation.md#metrics).
struct ErrorSummary {
  double mean_percent = 0;
  double rms_percent = 0;  // root of the mean squared vertex distance
  double p95_percent = 0;  // 95th percentile over all vertices of all frames
  double max_percent = 0;
  double mean_mm = 0;
  std::vector<double> frame_mean_percent;  // per compared frame
  double motion_mean_percent = 0;  // mean |(a_t - a_t-1) - (b_t - b_t-1)| over consecutive frames

  // How the motion looks. These values are not kept in model files. A count of zero means that
  // nothing was measured.
  int num_motion_frames = 0;  // frames whose predecessor was there
  double motion_mean_mm = 0;
  int num_jitter_frames = 0;  // frames whose predecessor and successor were there
  // The root of the mean squared second difference |x_t+1 - 2 x_t + x_t-1| of the vertices, of the
  // animation and of the truth: where the first is larger the animation shakes, where it is smaller
  // it glides.
  double jitter_mm = 0, truth_jitter_mm = 0;
};

// Collects the distances frame by frame, so that no second animation has to be in memory. It keeps
// one float per vertex and frame, for the percentile.
class ErrorAccumulator {
 public:
  // diagonal_m: the length of the reference diagonal in meters, > 0.
  explicit ErrorAccumulator(double diagonal_m) : diagonal_m_(diagonal_m) {}

  // Adds a frame. predicted, truth: 3 x V, meters. `follows_previous` says that this frame is the
  // successor in time of the frame added before, which makes the pair count for the motion error.
  void AddFrame(const Eigen::Ref<const Eigen::Matrix3Xd>& predicted,
                const Eigen::Ref<const Eigen::Matrix3Xd>& truth, bool follows_previous = true);

  ErrorSummary Summarize() const;

 private:
  double diagonal_m_;
  std::vector<float> distances_m_;
  std::vector<double> frame_mean_m_;
  double sum_m_ = 0, sum_squared_m2_ = 0;
  // The differences of the frame added last; positions of it and of the one before, 3 x V.
  Eigen::Matrix3Xd previous_difference_, predicted_[2], truth_[2];
  int run_length_ = 0;  // consecutive frames so far
  double motion_sum_m_ = 0, jitter_sum_m2_ = 0, truth_jitter_sum_m2_ = 0;
  int motion_frames_ = 0, jitter_frames_ = 0;
};

}  // namespace pleat
