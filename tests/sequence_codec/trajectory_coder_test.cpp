#include "trajectory_coder.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/status_matchers.h"

namespace pleat {
namespace {

TEST(TrajectoryCoderTest, DecoderGetsTheEncodersBitsWithinTheStep) {
  for (const int num_frames : {1, 2, 7, 175, 512}) {
    TrajectoryMatrix rows(3, num_frames);
    for (int t = 0; t < num_frames; ++t) {
      rows.col(t) << std::sin(0.1 * t), 0.01 * t, std::cos(0.7 * t);
    }
    const Eigen::Vector3d steps(0.01, 0.001, 0.05);
    TrajectoryMatrix coded = rows;
    BinaryCoder encoder = BinaryCoder::ForEncoding();
    ASSERT_THAT(CodeTrajectories(steps, &encoder, &coded), IsOk());
    for (int k = 0; k < 3; ++k) {
      const double rms = (coded.row(k) - rows.row(k)).norm() / std::sqrt(num_frames);
      EXPECT_LT(rms, 0.7 * steps[k]) << num_frames;
    }
    const std::string bytes = encoder.Finish();
    BinaryCoder decoder = BinaryCoder::ForDecoding(bytes);
    TrajectoryMatrix decoded = TrajectoryMatrix::Zero(3, num_frames);
    ASSERT_THAT(CodeTrajectories(steps, &decoder, &decoded), IsOk());
    EXPECT_EQ(decoded, coded);
  }
}

TEST(TrajectoryCoderTest, SmoothMotionIsCheap) {
  TrajectoryMatrix rows(1, 500);
  for (int t = 0; t < 500; ++t) rows(0, t) = std::sin(0.02 * t);
  BinaryCoder encoder = BinaryCoder::ForEncoding();
  ASSERT_THAT(CodeTrajectories(Eigen::VectorXd::Constant(1, 0.01), &encoder, &rows), IsOk());
  EXPECT_LT(encoder.Finish().size(), 60u);
}

}  // namespace
}  // namespace pleat
