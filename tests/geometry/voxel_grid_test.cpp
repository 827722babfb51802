#include "voxel_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "pleat/base/random.h"
#include "support/triangle_shapes.h"

namespace pleat {
namespace {

VoxelGrid Cube(int side) {
  VoxelGrid grid;
  grid.size = Eigen::Vector3i::Constant(side);
  return grid;
}

Eigen::Vector3i PlaceOf(const VoxelGrid& grid, int index) {
  return {index % grid.size.x(), index / grid.size.x() % grid.size.y(),
          index / (grid.size.x() * grid.size.y())};
}

TEST(VoxelGridTest, DistancesAreThoseOfTheNearestVoxel) {
  VoxelGrid grid = Cube(9);
  grid.size.y() = 7;
  VoxelMask mask(grid.num_voxels(), 0);
  Random random(3);
  for (int k = 0; k < 4; ++k) mask[static_cast<int>(random.Uniform(0, grid.num_voxels()))] = 1;
  constexpr int kReach = 3;
  const std::vector<uint8_t> distances = SquaredVoxelDistances(grid, mask, kReach);
  for (int i = 0; i < grid.num_voxels(); ++i) {
    int nearest = (kReach + 1) * (kReach + 1);
    for (int k = 0; k < grid.num_voxels(); ++k) {
      if (mask[k] == 0) continue;
      const int squared = (PlaceOf(grid, i) - PlaceOf(grid, k)).squaredNorm();
      if (squared <= kReach * kReach) nearest = std::min(nearest, squared);
    }
    if (distances[i] <= kReach * kReach || nearest <= kReach * kReach) {
      EXPECT_EQ(distances[i], nearest) << i;
    }
  }
}

// A path between voxels that share a face never slips through the surface, however it is turned.
TEST(VoxelGridTest, ARasterizedBallIsTight) {
  Random random(11);
  for (int repeat = 0; repeat < 5; ++repeat) {
    TriangleMesh ball = MakeSphere({0, 0, 0}, 1, 10);
    const Eigen::Quaterniond turn(random.Normal(), random.Normal(), random.Normal(),
                                  random.Normal());
    ball.positions = turn.normalized().toRotationMatrix() * ball.positions;
    const VoxelGrid grid =
        VoxelGrid::Around({Eigen::Vector3d::Constant(-1), Eigen::Vector3d::Constant(1)}, 37, 2);
    const VoxelMask outside =
        FloodOutside(grid, RasterizeTriangles(grid, ball.positions, ball.triangles, {}));
    EXPECT_EQ(outside[grid.IndexAt({0, 0, 0})], 0);
    EXPECT_EQ(outside[grid.IndexAt({.9, .9, .9})], 1);
  }
}

TEST(VoxelGridTest, PiecesHangTogetherThroughFaces) {
  const VoxelGrid grid = Cube(4);
  VoxelMask mask(grid.num_voxels(), 0);
  for (const Eigen::Vector3i& at : {Eigen::Vector3i(0, 0, 0), Eigen::Vector3i(1, 0, 0),
                                    Eigen::Vector3i(2, 1, 0), Eigen::Vector3i(3, 3, 3)}) {
    mask[grid.Index(at)] = 1;
  }
  std::vector<int> labels;
  EXPECT_EQ(LabelPieces(grid, mask, &labels), 3);
  EXPECT_EQ(labels[grid.Index({0, 0, 0})], labels[grid.Index({1, 0, 0})]);
  EXPECT_NE(labels[grid.Index({1, 0, 0})], labels[grid.Index({2, 1, 0})]);
  EXPECT_EQ(std::ranges::count(labels, 0), grid.num_voxels() - 4);
}

}  // namespace
}  // namespace pleat
