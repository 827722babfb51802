#include "delta_predictor.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pleat/base/random.h"
#include "stream/draco_bytes.h"
#include "support/test_meshes.h"

namespace pleat {
namespace {

constexpr int64_t kMaxCoordinate = int64_t{1} << 26;

Eigen::Matrix3Xi RandomIntegers(int count, int spread, uint64_t seed) {
  Random random(seed);
  Eigen::Matrix3Xi integers(3, count);
  for (int& k : integers.reshaped()) k = random.UniformInt(2 * spread + 1) - spread;
  return integers;
}

Eigen::Matrix3Xi Snapped(const Eigen::Matrix3Xf& positions, const QuantizationBox& box) {
  Eigen::Matrix3Xi integers;
  SnapToGrid(positions, box, &integers);
  return integers;
}

Eigen::Matrix3Xi ResidualsOf(const DeltaPredictor& predictor, const Eigen::Matrix3Xi& last,
                             const Eigen::Matrix3Xi& now) {
  Eigen::Matrix3Xi movement, residuals;
  predictor.Residuals(last, now, &movement, &residuals);
  return residuals;
}

TEST(SnapToGridTest, EveryCoordinateGoesToTheNearestGridPoint) {
  Random random(1);
  for (const int bits : {8, 12, 20}) {
    const QuantizationBox box = TorusBox(bits);
    Eigen::Matrix3Xf positions(3, 500);
    // Far outside of the box too: it does not clip.
    for (float& x : positions.reshaped()) x = static_cast<float>(random.Uniform(-20, 20));
    const Eigen::Matrix3Xi integers = Snapped(positions, box);
    for (int v = 0; v < positions.cols(); ++v) {
      for (int c = 0; c < 3; ++c) {
        const double exact = (double{positions(c, v)} - box.origin_m[c]) / box.step_m();
        EXPECT_LE(std::fabs(integers(c, v) - exact), .5 + 1e-6) << bits << " " << v;
      }
    }
  }
}

TEST(SnapToGridTest, GridPointsComeBackAsTheyAre) {
  const QuantizationBox box = TorusBox();
  const Eigen::Matrix3Xi integers = RandomIntegers(400, 16 * 4096, 2);
  Eigen::Matrix3Xf positions;
  PlaceOnGrid(integers, box, &positions);
  ASSERT_EQ(positions.cols(), integers.cols());
  EXPECT_EQ(Snapped(positions, box), integers);
}

// FNV-1a of 32-bit words, as docs/formats/frame_stream.md has it, written a second time.
TEST(GridChecksumTest, IsFnv1aOverTheWords) {
  EXPECT_EQ(GridChecksum(Eigen::Matrix3Xi(3, 0)), 0x811c9dc5u);
  uint32_t expected = 0x811c9dc5u;
  for (const uint32_t word : {1u, 0xfffffffeu, 3u, 40u, 50u, 60u}) {
    expected ^= word;
    expected *= 0x01000193u;
  }
  Eigen::Matrix3Xi integers(3, 2);
  integers << 1, 40, -2, 50, 3, 60;
  EXPECT_EQ(GridChecksum(integers), expected);
}

TEST(GridChecksumTest, SeesEveryStepAndEveryOrder) {
  const Eigen::Matrix3Xi integers = RandomIntegers(50, 1000, 3);
  const uint32_t checksum = GridChecksum(integers);
  for (int i = 0; i < integers.size(); ++i) {
    Eigen::Matrix3Xi changed = integers;
    changed(i) += 1;
    EXPECT_NE(GridChecksum(changed), checksum) << i;
  }
  Eigen::Matrix3Xi swapped = integers;
  swapped.col(3).swap(swapped.col(4));
  EXPECT_NE(GridChecksum(swapped), checksum);
}

class DeltaPredictorTest : public testing::Test {
 protected:
  const TestMesh torus_ = MakeTorus(24, 12, 3);
  const QuantizationBox box_ = TorusBox();
  const DeltaPredictor predictor_{torus_.topology, torus_.positions, box_};
  const int num_vertices_ = static_cast<int>(torus_.positions.cols());
};

TEST_F(DeltaPredictorTest, RestoreInvertsResidualsForSmoothMotionAndForNoise) {
  const Eigen::Matrix3Xi rest = Snapped(torus_.positions, box_);
  for (const Eigen::Matrix3Xi& now :
       {Snapped(Bend(torus_.positions, 5), box_), rest,
        Eigen::Matrix3Xi(rest + RandomIntegers(num_vertices_, 9000, 4))}) {
    Eigen::Matrix3Xi restored;
    const Eigen::Matrix3Xi residuals = ResidualsOf(predictor_, rest, now);
    ASSERT_TRUE(predictor_.Restore(rest, residuals, &restored));
    EXPECT_EQ(restored, now);
  }
}

TEST_F(DeltaPredictorTest, NoMotionLeavesNothing) {
  const Eigen::Matrix3Xi still = RandomIntegers(num_vertices_, 4000, 5);
  const Eigen::Matrix3Xi residuals = ResidualsOf(predictor_, still, still);
  EXPECT_TRUE(residuals.isZero());
}

// Shares that do not sum to one would leave something at every vertex.
TEST_F(DeltaPredictorTest, ATranslationCostsOneVertex) {
  const Eigen::Matrix3Xi last = RandomIntegers(num_vertices_, 4000, 6);
  const Eigen::Vector3i shift(17, -230, 4001);
  const Eigen::Matrix3Xi residuals = ResidualsOf(predictor_, last, last.colwise() + shift);
  EXPECT_EQ(residuals.col(0), shift);
  EXPECT_TRUE(residuals.rightCols(num_vertices_ - 1).isZero());
}

TEST_F(DeltaPredictorTest, SmoothMotionLeavesLessThanItMoves) {
  const Eigen::Matrix3Xi last = Snapped(torus_.positions, box_);
  const Eigen::Matrix3Xi now = Snapped(Bend(torus_.positions, 4), box_);
  const Eigen::Matrix3Xi residuals = ResidualsOf(predictor_, last, now);
  EXPECT_LT(4 * residuals.cwiseAbs().cast<int64_t>().sum(),
            (now - last).cwiseAbs().cast<int64_t>().sum());
}

TEST_F(DeltaPredictorTest, AgreesWithAnotherOneOfTheSameHeader) {
  const DeltaPredictor other(torus_.topology, torus_.positions, box_);
  const Eigen::Matrix3Xi last = RandomIntegers(num_vertices_, 4000, 7);
  const Eigen::Matrix3Xi now = last + RandomIntegers(num_vertices_, 300, 8);
  EXPECT_EQ(ResidualsOf(predictor_, last, now), ResidualsOf(other, last, now));
}

// Damaged residuals must not overflow an integer, whichever vertex they hit.
TEST_F(DeltaPredictorTest, ResidualsThatLeaveWhatIsAllowedAreRefused) {
  const Eigen::Matrix3Xi last = Snapped(torus_.positions, box_);
  for (const int column : {0, 1, num_vertices_ / 2, num_vertices_ - 1}) {
    for (const int bad : {std::numeric_limits<int>::max(), std::numeric_limits<int>::min(),
                          static_cast<int>(kMaxCoordinate) + 100'000}) {
      Eigen::Matrix3Xi residuals = Eigen::Matrix3Xi::Zero(3, num_vertices_);
      residuals(column % 3, column) = bad;
      Eigen::Matrix3Xi restored;
      EXPECT_FALSE(predictor_.Restore(last, residuals, &restored)) << column << " " << bad;
    }
  }
}

TEST_F(DeltaPredictorTest, VerticesWithoutNeighborsFollowTheOneBefore) {
  const TestMesh mesh = WithExtra(torus_, 5, {});  // 5 vertices that no triangle uses
  const DeltaPredictor predictor(mesh.topology, mesh.positions, box_);
  const Eigen::Matrix3Xi last = Snapped(mesh.positions, box_);
  const Eigen::Matrix3Xi now = last.colwise() + Eigen::Vector3i(3, 2, 1);
  Eigen::Matrix3Xi residuals, restored;
  residuals = ResidualsOf(predictor, last, now);
  EXPECT_TRUE(residuals.rightCols(residuals.cols() - 1).isZero());
  ASSERT_TRUE(predictor.Restore(last, residuals, &restored));
  EXPECT_EQ(restored, now);
}

}  // namespace
}  // namespace pleat
