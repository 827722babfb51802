#include "pleat/mesh/error_metrics.h"

#include <gtest/gtest.h>

#include <cmath>

namespace pleat {
namespace {

Eigen::Matrix3Xd Offsets(const std::vector<double>& x) {
  Eigen::Matrix3Xd positions = Eigen::Matrix3Xd::Zero(3, static_cast<int>(x.size()));
  for (size_t v = 0; v < x.size(); ++v) positions(0, static_cast<int>(v)) = x[v];
  return positions;
}

TEST(ErrorMetricsTest, KnownDistances) {
  ErrorAccumulator errors(2.0);  // 1 % = 20 mm
  errors.AddFrame(Offsets({0.03, -0.04}), Offsets({0, 0}));
  errors.AddFrame(Offsets({0, 0.01}), Offsets({0, 0}));
  const ErrorSummary summary = errors.Summarize();
  EXPECT_NEAR(summary.mean_mm, 20, 1e-9);
  EXPECT_NEAR(summary.mean_percent, 1, 1e-9);
  EXPECT_NEAR(summary.rms_percent, 50 * std::sqrt((9 + 16 + 1) * 1e-4 / 4), 1e-9);
  EXPECT_NEAR(summary.max_percent, 2, 1e-6);
  EXPECT_NEAR(summary.p95_percent, 1.5, 1e-6);  // nearest rank below 95 % of four values
  ASSERT_EQ(summary.frame_mean_percent.size(), 2u);
  EXPECT_NEAR(summary.frame_mean_percent[0], 1.75, 1e-9);
  EXPECT_NEAR(summary.frame_mean_percent[1], 0.25, 1e-9);
}

TEST(ErrorMetricsTest, ConstantOffsetHasNoMotionError) {
  ErrorAccumulator errors(1);
  for (int t = 0; t < 4; ++t)
    errors.AddFrame(Offsets({t + 0.5, 2.0 * t + 0.5}), Offsets({1.0 * t, 2.0 * t}));
  EXPECT_NEAR(errors.Summarize().mean_percent, 50, 1e-9);
  EXPECT_NEAR(errors.Summarize().motion_mean_percent, 0, 1e-9);
}

TEST(ErrorMetricsTest, MotionErrorSkipsFramesThatDoNotFollow) {
  ErrorAccumulator errors(1);
  errors.AddFrame(Offsets({0.1}), Offsets({0}));
  errors.AddFrame(Offsets({0.3}), Offsets({0}), /*follows_previous=*/false);
  errors.AddFrame(Offsets({0.35}), Offsets({0}));
  EXPECT_NEAR(errors.Summarize().motion_mean_percent, 5, 1e-9);  // only the last pair
}

TEST(ErrorMetricsTest, JitterIsTheSecondDifferenceWithinRuns) {
  ErrorAccumulator errors(1);
  // The truth glides, the animation goes to and fro by 3 mm; another run of two frames adds no
  // second difference.
  for (int t = 0; t < 5; ++t) {
    errors.AddFrame(Offsets({.01 * t + .003 * (t % 2), .01 * t}), Offsets({.01 * t, .01 * t}));
  }
  errors.AddFrame(Offsets({7, 7}), Offsets({0, 0}), /*follows_previous=*/false);
  errors.AddFrame(Offsets({7, 7}), Offsets({0, 0}));
  const ErrorSummary summary = errors.Summarize();
  EXPECT_EQ(summary.num_jitter_frames, 3);
  EXPECT_EQ(summary.num_motion_frames, 5);
  EXPECT_NEAR(summary.jitter_mm, 6 / std::sqrt(2), 1e-9);  // of two vertices one shakes
  EXPECT_NEAR(summary.truth_jitter_mm, 0, 1e-9);
  EXPECT_NEAR(summary.motion_mean_mm, 1.5 * 4 / 5, 1e-9);
}

TEST(ErrorMetricsTest, NothingAddedIsAllZero) {
  const ErrorSummary summary = ErrorAccumulator(1).Summarize();
  EXPECT_EQ(summary.mean_percent, 0);
  EXPECT_TRUE(summary.frame_mean_percent.empty());
}

}  // namespace
}  // namespace pleat
