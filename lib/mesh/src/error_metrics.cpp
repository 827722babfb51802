#include "pleat/mesh/error_metrics.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace pleat {

void ErrorAccumulator::AddFrame(const Eigen::Ref<const Eigen::Matrix3Xd>& predicted,
                                const Eigen::Ref<const Eigen::Matrix3Xd>& truth,
                                bool follows_previous) {
  assert(predicted.cols() == truth.cols());
  const Eigen::Matrix3Xd difference = predicted - truth;
  const Eigen::VectorXd distances = difference.colwise().norm().transpose();
  for (const double distance : distances) distances_m_.push_back(static_cast<float>(distance));
  sum_m_ += distances.sum();
  sum_squared_m2_ += distances.squaredNorm();
  frame_mean_m_.push_back(distances.mean());
  // A run of consecutive frames: the motion error needs two of them, the jitter three.
  const bool follows = follows_previous && previous_difference_.cols() == difference.cols();
  run_length_ = follows ? run_length_ + 1 : 1;
  if (run_length_ >= 2) {
    motion_sum_m_ += (difference - previous_difference_).colwise().norm().mean();
    ++motion_frames_;
  }
  if (run_length_ >= 3) {
    const double count = static_cast<double>(difference.cols());
    jitter_sum_m2_ += (predicted - 2 * predicted_[0] + predicted_[1]).squaredNorm() / count;
    truth_jitter_sum_m2_ += (truth - 2 * truth_[0] + truth_[1]).squaredNorm() / count;
    ++jitter_frames_;
  }
  previous_difference_ = difference;
  predicted_[1].swap(predicted_[0]);
  truth_[1].swap(truth_[0]);
  predicted_[0] = predicted;
  truth_[0] = truth;
}

ErrorSummary ErrorAccumulator::Summarize() const {
  ErrorSummary summary;
  if (distances_m_.empty()) return summary;
  const double to_percent = 100 / diagonal_m_;
  const double count = static_cast<double>(distances_m_.size());
  summary.mean_percent = sum_m_ / count * to_percent;
  summary.rms_percent = std::sqrt(sum_squared_m2_ / count) * to_percent;
  std::vector<float> sorted = distances_m_;
  // The 95th percentile over all vertices of all frames, without interpolation between ranks.
  const size_t rank = static_cast<size_t>(0.95 * (count - 1));
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<long>(rank), sorted.end());
  summary.p95_percent = sorted[rank] * to_percent;
  summary.max_percent = *std::max_element(sorted.begin(), sorted.end()) * to_percent;
  summary.mean_mm = sum_m_ / count * 1000;
  for (const double mean : frame_mean_m_) summary.frame_mean_percent.push_back(mean * to_percent);
  summary.num_motion_frames = motion_frames_;
  summary.num_jitter_frames = jitter_frames_;
  if (motion_frames_ > 0) {
    summary.motion_mean_mm = motion_sum_m_ / motion_frames_ * 1000;
    summary.motion_mean_percent = motion_sum_m_ / motion_frames_ * to_percent;
  }
  if (jitter_frames_ > 0) {
    summary.jitter_mm = std::sqrt(jitter_sum_m2_ / jitter_frames_) * 1000;
    summary.truth_jitter_mm = std::sqrt(truth_jitter_sum_m2_ / jitter_frames_) * 1000;
  }
  return summary;
}

}  // namespace pleat
