#include "support/mesh_shapes.h"

#include <gtest/gtest.h>

#include <numbers>

#include "pleat/mesh/mesh_report.h"

namespace pleat {
namespace {

constexpr double kPi = std::numbers::pi;

MeshReport Inspect(const MeshShape& shape) { return InspectMesh(shape.topology, shape.positions); }

TEST(ShapesTest, ClosedShapesAreCleanAndHaveTheirVolume) {
  const MeshReport box = Inspect(MakeBox({1, 2, 3}));
  EXPECT_TRUE(DescribeFaults(box).empty());
  EXPECT_NEAR(box.signed_volume_m3, 6, 1e-12);

  const MeshReport sphere = Inspect(MakeUvSphere(0.5, 80, 160));
  EXPECT_TRUE(DescribeFaults(sphere).empty());
  EXPECT_NEAR(sphere.signed_volume_m3, kPi / 6, 1e-3);

  const MeshReport capsule = Inspect(MakeCapsule(0.5, 2, 10, 40, 160));
  EXPECT_TRUE(DescribeFaults(capsule).empty());
  EXPECT_NEAR(capsule.signed_volume_m3, kPi / 6 + kPi / 2, 2e-3);
  EXPECT_NEAR(capsule.bounds.sizes().y(), 3, 1e-12);
}

TEST(ShapesTest, EulerCharacteristicOfTheSphere) {
  const MeshShape sphere = MakeUvSphere(1, 5, 8);
  EXPECT_EQ(sphere.topology.num_vertices(), 5 * 8 + 2);
  EXPECT_EQ(sphere.topology.num_faces(), 4 * 8 + 2 * 8);
  const int num_edges = sphere.topology.num_corners() / 2;
  EXPECT_EQ(sphere.topology.num_vertices() - num_edges + sphere.topology.num_faces(), 2);
}

TEST(ShapesTest, OpenShapesHaveTheirBoundary) {
  const MeshReport tube = Inspect(MakeTube(1, 2, 4, 12));
  EXPECT_EQ(tube.num_boundary_edges, 24);
  EXPECT_GT(tube.signed_volume_m3, 0);
  const MeshReport grid = Inspect(MakeGrid(3, 5, 1, 2));
  EXPECT_EQ(grid.num_boundary_edges, 16);
  EXPECT_EQ(grid.num_faces, 15);
}

}  // namespace
}  // namespace pleat
