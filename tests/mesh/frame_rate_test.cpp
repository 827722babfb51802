#include "pleat/mesh/frame_rate.h"

#include <gtest/gtest.h>

namespace pleat {
namespace {

TEST(FrameRateTest, RecognizesTheFractionsOfVideo) {
  EXPECT_EQ(FrameRateFromFps(30), (FrameRate{30, 1}));
  EXPECT_EQ(FrameRateFromFps(30000 / 1001.0), (FrameRate{30000, 1001}));
  EXPECT_EQ(FrameRateFromFps(24000 / 1001.0), (FrameRate{24000, 1001}));
  EXPECT_EQ(FrameRateFromFps(12.5), (FrameRate{25, 2}));
}

TEST(FrameRateTest, NeverGivesZero) {
  EXPECT_EQ(FrameRateFromFps(1e-9), (FrameRate{1, 1000}));
  EXPECT_EQ(FrameRateFromFps(10000), (FrameRate{10000, 1}));
}

}  // namespace
}  // namespace pleat
