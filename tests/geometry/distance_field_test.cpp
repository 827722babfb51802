#include "pleat/geometry/distance_field.h"

#include <gtest/gtest.h>

#include "pleat/base/random.h"
#include "support/status_matchers.h"
#include "support/triangle_shapes.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

absl::StatusOr<DistanceField> FieldOf(const TriangleMesh& mesh, int resolution, int num_threads = 1,
                                      const Progress& progress = {}) {
  const TriangleTree tree(mesh.positions, mesh.triangles);
  const WindingNumber winding_number(tree);
  DistanceFieldOptions options;
  options.resolution = resolution;
  options.num_threads = num_threads;
  return DistanceField::Compute(tree, winding_number, options, progress);
}

TEST(DistanceFieldTest, AgreesWithASphere) {
  const Eigen::Vector3d center(.5, -1, 2);
  PLEAT_ASSERT_OK_AND_ASSIGN(const DistanceField field, FieldOf(MakeSphere(center, .8, 48), 48));
  Random random(4);
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3d offset(random.Normal(), random.Normal(), random.Normal());
    const Eigen::Vector3d point = center + random.Uniform(0, .85) * offset.normalized();
    EXPECT_NEAR(field.SignedDistance(point), (point - center).norm() - .8, .02);
  }
}

TEST(DistanceFieldTest, AgreesWithABoxAwayFromItsEdges) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const DistanceField field,
                             FieldOf(MakeBox({0, 0, 0}, {1, 2, .5}), 64));
  EXPECT_NEAR(field.SignedDistance({.5, 1, .1}), -.1, .001);
  EXPECT_NEAR(field.SignedDistance({.2, 1, .25}), -.2, .01);
  EXPECT_NEAR(field.SignedDistance({.5, 1, .52}), .02, .005);
  EXPECT_GT(field.SignedDistance({.5, 1, .9}), 0);   // outside the grid
  EXPECT_GT(field.SignedDistance({50, 50, 50}), 0);  // far outside
  EXPECT_GT(field.SignedDistance({std::nan(""), 0, 0}), 0);
}

TEST(DistanceFieldTest, SegmentsReportTheirShallowestPoint) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const DistanceField field,
                             FieldOf(MakeBox({0, 0, 0}, {1, 2, .5}), 64));
  EXPECT_NEAR(field.MaxAlongSegment({.5, .5, .25}, {.5, 1.5, .25}), -.25, .02);
  EXPECT_NEAR(field.MaxAlongSegment({.5, .5, .25}, {.5, 1, .05}), -.05, .01);
  EXPECT_GT(field.MaxAlongSegment({.5, .5, .25}, {1.5, .5, .25}), 0);
}

TEST(DistanceFieldTest, ThreadsDoNotChangeIt) {
  const TriangleMesh mesh = MakeSphere({0, 0, 0}, 1, 16);
  PLEAT_ASSERT_OK_AND_ASSIGN(const DistanceField one, FieldOf(mesh, 24, 1));
  PLEAT_ASSERT_OK_AND_ASSIGN(const DistanceField four, FieldOf(mesh, 24, 4));
  ASSERT_EQ(one.num_nodes(), four.num_nodes());
  for (int n = 0; n < one.num_nodes().prod(); ++n) {
    ASSERT_EQ(one.node_distance(n), four.node_distance(n));
  }
}

// Two bodies that overlap, a cavity, and thin walls: the same field, with few winding numbers.
TEST(DistanceFieldTest, KnowingThatASurfaceIsClosedChangesNothing) {
  TriangleMesh cavity = MakeSphere({.1, .1, 0}, .5, 20);
  cavity.triangles.row(0).swap(cavity.triangles.row(1));
  const TriangleMesh mesh =
      JoinMeshes(JoinMeshes(MakeSphere({0, 0, 0}, 1, 30), MakeSphere({1.2, .3, 0}, .6, 20)),
                 JoinMeshes(cavity, MakeBox({-1, 1.2, -1}, {1, 1.204, 1})));
  const TriangleTree tree(mesh.positions, mesh.triangles);
  const WindingNumber winding_number(tree);
  DistanceFieldOptions options;
  options.resolution = 60;
  PLEAT_ASSERT_OK_AND_ASSIGN(const DistanceField expected,
                             DistanceField::Compute(tree, winding_number, options));
  options.is_closed = true;
  PLEAT_ASSERT_OK_AND_ASSIGN(const DistanceField field,
                             DistanceField::Compute(tree, winding_number, options));
  for (int n = 0; n < field.num_nodes().prod(); ++n) {
    ASSERT_NEAR(field.node_distance(n), expected.node_distance(n), 1e-6) << n;
    // Where two surface points are equally near, either may be found.
    if (field.node_direction(n).isZero() != expected.node_direction(n).isZero()) {
      ADD_FAILURE() << n;
    }
  }
}

TEST(DistanceFieldTest, RefusesWhatHasNoExtent) {
  EXPECT_THAT(FieldOf({Eigen::Matrix3Xd(3, 0), Eigen::Matrix3Xi(3, 0)}, 32),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("at least one triangle")));
  TriangleMesh point{Eigen::Matrix3Xd::Ones(3, 3), Eigen::Vector3i(0, 1, 2)};
  EXPECT_THAT(FieldOf(point, 32),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("no extent")));
  EXPECT_THAT(FieldOf(MakeSphere({0, 0, 0}, 1, 8), 100000),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("resolution")));
}

TEST(DistanceFieldTest, CanBeCancelled) {
  const Progress cancelled({}, [] { return true; });
  EXPECT_TRUE(absl::IsCancelled(FieldOf(MakeSphere({0, 0, 0}, 1, 8), 32, 1, cancelled).status()));
}

}  // namespace
}  // namespace pleat
