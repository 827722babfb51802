// Named errors between two animations: distances of corresponding vertices.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace pleat {

// Percent values are of the bounding-box diagonal of the rest frame (method.md, section 6).
struct ErrorSummary {
  double mean_percent = 0;
  double rms_percent = 0;  // root of the mean squared vertex distance
  double p95_percent = 0;  // 95th percentile over all vertices of all frames
  double max_percent = 0;
  double mean_mm = 0;
  std::vector<double> frame_mean_percent;  // per compared frame
  double motion_mean_percent = 0;  // mean |(a_t - a_t-1) - (b_t - b_t-1)| over consecutive frames
};

// Collects the distances frame by frame, so that no second animation has to be in memory.
class ErrorAccumulator {
 public:
  // diagonal_m: length of the reference diagonal, metres, > 0.
  explicit ErrorAccumulator(double diagonal_m) : diagonal_m_(diagonal_m) {}

  // predicted, truth: 3 x V, metres. `follows_previous` says that this frame is the successor in
  // time of the frame added before, which makes the pair count for the motion error.
  void AddFrame(const Eigen::Ref<const Eigen::Matrix3Xd>& predicted,
                const Eigen::Ref<const Eigen::Matrix3Xd>& truth, bool follows_previous = true);

  ErrorSummary Summarize() const;

 private:
  double diagonal_m_;
  std::vector<float> distances_m_;
  std::vector<double> frame_mean_m_;
  double sum_m_ = 0, sum_squared_m2_ = 0;
  Eigen::Matrix3Xd previous_difference_;  // 3 x V, of the frame added last
  double motion_sum_m_ = 0;
  long motion_count_ = 0;
};

}  // namespace pleat
