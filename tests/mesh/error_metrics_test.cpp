#include "pleat/mesh/error_metrics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "pleat/base/random.h"

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

class RandomErrors {
 public:
  RandomErrors() {
    Random random(2);
    for (int t = 0; t < kFrames; ++t) {
      for (auto* frames : {&predicted, &truth}) {
        frames->emplace_back(3, kVertices);
        for (double& x : frames->back().reshaped()) x = random.Uniform(-1, 1);
      }
    }
  }
  // With every position x taken to scale * (rotation * x + offset).
  ErrorSummary Summarize(double scale, const Eigen::Matrix3d& rotation,
                         const Eigen::Vector3d& offset) const {
    ErrorAccumulator errors(2 * scale);
    for (int t = 0; t < kFrames; ++t) {
      errors.AddFrame(scale * ((rotation * predicted[t]).colwise() + offset),
                      scale * ((rotation * truth[t]).colwise() + offset));
    }
    return errors.Summarize();
  }

  static constexpr int kFrames = 6, kVertices = 40;
  std::vector<Eigen::Matrix3Xd> predicted, truth;
};

TEST(ErrorMetricsTest, PercentsDoNotDependOnPlaceAxesAndUnits) {
  const RandomErrors errors;
  const ErrorSummary a = errors.Summarize(1, Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero());
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  const ErrorSummary b = errors.Summarize(1000, turn, {5, -3, 2});
  for (double ErrorSummary::*value :
       {&ErrorSummary::mean_percent, &ErrorSummary::rms_percent, &ErrorSummary::p95_percent,
        &ErrorSummary::max_percent, &ErrorSummary::motion_mean_percent}) {
    EXPECT_GT(a.*value, 0);
    EXPECT_NEAR(a.*value, b.*value, 1e-4 * (a.*value));
  }
  EXPECT_NEAR(1000 * a.mean_mm, b.mean_mm, 1e-6 * b.mean_mm);
  EXPECT_NEAR(1000 * a.jitter_mm, b.jitter_mm, 1e-6 * b.jitter_mm);
  EXPECT_NEAR(1000 * a.truth_jitter_mm, b.truth_jitter_mm, 1e-6 * b.truth_jitter_mm);
}

TEST(ErrorMetricsTest, NinetyFivePercentOfAllDistancesAreAtMostThePercentile) {
  const RandomErrors errors;
  const ErrorSummary summary =
      errors.Summarize(1, Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero());
  std::vector<double> percents;
  for (int t = 0; t < RandomErrors::kFrames; ++t) {
    for (const double m : (errors.predicted[t] - errors.truth[t]).colwise().norm()) {
      percents.push_back(50 * m);
    }
  }
  std::sort(percents.begin(), percents.end());
  EXPECT_NEAR(summary.p95_percent, percents[static_cast<size_t>(.95 * (percents.size() - 1))],
              1e-4);
  EXPECT_NEAR(summary.max_percent, percents.back(), 1e-4);
}

}  // namespace
}  // namespace pleat
