#include "pleat/geometry/surface_cells.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "support/test_meshes.h"

namespace pleat {
namespace {

TEST(SurfaceCellsTest, CentersAreSpreadAndNeighborsTouch) {
  const TestMesh torus = MakeTorus(40, 20, 2);
  const Eigen::Matrix3Xd positions = torus.positions.cast<double>();
  const SurfaceCells cells = MakeSurfaceCells(torus.topology, positions, 60);
  ASSERT_EQ(cells.centers.size(), 60u);
  EXPECT_EQ(cells.centers[0], 0);
  EXPECT_EQ(std::set<int>(cells.centers.begin(), cells.centers.end()).size(), 60u);
  double closest = 1e9, farthest = 0;
  for (size_t a = 0; a < 60; ++a) {
    for (size_t b = 0; b < a; ++b) {
      closest = std::min(
          closest, (positions.col(cells.centers[a]) - positions.col(cells.centers[b])).norm());
    }
  }
  for (Eigen::Index v = 0; v < positions.cols(); ++v) {
    double nearest = 1e9;
    for (const int center : cells.centers) {
      nearest = std::min(nearest, (positions.col(v) - positions.col(center)).norm());
    }
    farthest = std::max(farthest, nearest);
  }
  EXPECT_LE(farthest, closest + 1e-12);  // what farthest-point sampling promises
  // A closed surface: about three pairs for each cell (Euler), none twice, the smaller first.
  EXPECT_GT(cells.neighbors.size(), 150u);
  EXPECT_LT(cells.neighbors.size(), 200u);
  EXPECT_TRUE(std::is_sorted(cells.neighbors.begin(), cells.neighbors.end()));
  for (const auto& [first, second] : cells.neighbors) {
    EXPECT_LT(first, second);
    EXPECT_LT((positions.col(cells.centers[first]) - positions.col(cells.centers[second])).norm(),
              4 * farthest);
  }
}

TEST(SurfaceCellsTest, CellsOfTwoComponentsDoNotTouch) {
  const TestMesh torus = MakeTorus(12, 8, 1);
  const int count = torus.topology.num_vertices();
  std::vector<int32_t> corners, sizes;
  for (int copy = 0; copy < 2; ++copy) {
    for (int f = 0; f < torus.topology.num_faces(); ++f) {
      for (const int v : torus.topology.face(f)) corners.push_back(v + copy * count);
      sizes.push_back(static_cast<int32_t>(torus.topology.face(f).size()));
    }
  }
  Eigen::Matrix3Xd positions(3, 2 * count);
  positions.leftCols(count) = torus.positions.cast<double>();
  positions.rightCols(count) =
      torus.positions.cast<double>().colwise() + Eigen::Vector3d(.001, .002, 0);
  const Topology both = Topology::Create(2 * count, corners, sizes).value();
  const SurfaceCells cells = MakeSurfaceCells(both, positions, 40);
  for (const auto& [first, second] : cells.neighbors) {
    EXPECT_EQ(cells.centers[first] < count, cells.centers[second] < count);
  }
}

TEST(SurfaceCellsTest, PlacesAreTakenOnce) {
  const TestMesh torus = MakeTorus(6, 5, 1);
  Eigen::Matrix3Xd positions = torus.positions.cast<double>();
  positions.rightCols(20).colwise() = Eigen::Vector3d(positions.col(0));
  EXPECT_EQ(MakeSurfaceCells(torus.topology, positions, 100).centers.size(), 10u);
}

}  // namespace
}  // namespace pleat
