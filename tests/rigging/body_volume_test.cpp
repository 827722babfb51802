#include "pleat/rigging/body_volume.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "pleat/mesh/bounds.h"
#include "pleat/rigging/bone_visibility.h"
#include "support/status_matchers.h"
#include "support/triangle_shapes.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

TEST(BodyVolumeTest, FitsTheUnitBox) {
  const TriangleMesh mesh = MakeBox({100, -20, 3}, {102, -16, 4});
  PLEAT_ASSERT_OK_AND_ASSIGN(const BodyVolume volume,
                             ComputeBodyVolume(MakeTopology(mesh), mesh.positions));
  const Eigen::AlignedBox3d box = ComputeBounds(volume.body->shell.positions);
  EXPECT_NEAR(box.sizes().maxCoeff(), .9, 1e-12);
  EXPECT_LT((box.center() - Eigen::Vector3d::Constant(.5)).norm(), 1e-9);
  const Eigen::Vector3d corner = volume.UnitFromWorld(Eigen::Vector3d(100, -20, 3));
  EXPECT_LT((corner - box.min()).norm(), 1e-9);
  EXPECT_GT(volume.medial_samples.size(), 100u);
  EXPECT_FALSE(volume.body->is_repaired);
  EXPECT_EQ(volume.body->shell.triangles, mesh.triangles);
}

// One closed surface that overlaps itself counts as unclean, as several do.
TEST(BodyVolumeTest, OverlapsAreReplacedByTheUnion) {
  TriangleMesh twice = MakeBox({0, 0, 0}, {1, 3, 1});
  const TriangleMesh arm = MakeBox({.5, 1, .2}, {2, 1.5, .8});
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const BodySurface apart,
      PrepareBodySurface(MakeTopology(JoinMeshes(twice, arm)), JoinMeshes(twice, arm).positions));
  EXPECT_TRUE(apart.is_repaired);
  // A triangle of each is opened to a common hole, which keeps the surface closed.
  TriangleMesh joined = JoinMeshes(twice, arm);
  const Eigen::Vector3i a = joined.triangles.col(0), b = joined.triangles.col(12);
  std::vector<Eigen::Vector3i> kept;
  for (int f = 0; f < joined.triangles.cols(); ++f) {
    if (f != 0 && f != 12) kept.push_back(joined.triangles.col(f));
  }
  for (int k = 0; k < 3; ++k) {
    kept.emplace_back(a[k], a[(k + 1) % 3], b[(3 - k) % 3]);
    kept.emplace_back(a[(k + 1) % 3], b[(5 - k) % 3], b[(3 - k) % 3]);
  }
  joined.triangles.resize(3, static_cast<Eigen::Index>(kept.size()));
  for (size_t f = 0; f < kept.size(); ++f) {
    joined.triangles.col(static_cast<Eigen::Index>(f)) = kept[f];
  }
  PLEAT_ASSERT_OK_AND_ASSIGN(const BodySurface one,
                             PrepareBodySurface(MakeTopology(joined), joined.positions));
  const SolidSurface surface = PrepareSolidSurface(MakeTopology(joined), joined.positions).value();
  ASSERT_TRUE(surface.report.closed());
  ASSERT_EQ(surface.report.num_components, 1);
  EXPECT_TRUE(one.is_repaired);
}

// A capsule is all points at most a radius away from a segment, so everything is known.
TEST(BodyVolumeTest, DistancesAndMiddlesOfACapsuleAreKnown) {
  const Eigen::Vector3d start(0, .2, 0), end(.3, 1.5, .2);
  constexpr double kRadius = .2;
  const TriangleMesh mesh = MakeCapsuleBody({{start, end, kRadius, kRadius}}, .03);
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const BodyVolume volume,
      ComputeBodyVolume(MakeTopology(mesh), mesh.positions, {.resolution = 64}));
  const auto distance_to_axis = [&](const Eigen::Vector3d& point_m) {
    return (ClosestPointOnSegment(point_m, start, end) - point_m).norm();
  };
  for (const Eigen::Vector3d& offset :
       {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(.1, 0, 0), Eigen::Vector3d(0, -.05, .12),
        Eigen::Vector3d(0, 0, -.25)}) {
    const Eigen::Vector3d point_m = .4 * start + .6 * end + offset;
    const double found =
        volume.field.SignedDistance(volume.body->scale * point_m + volume.body->offset) /
        volume.body->scale;
    EXPECT_NEAR(found, distance_to_axis(point_m) - kRadius, .015);
  }
  const double spacing_m = volume.field.spacing() / volume.body->scale;
  double deepest = 0;
  for (const MedialSample& sample : volume.medial_samples) {
    const Eigen::Vector3d point_m = (sample.position - volume.body->offset) / volume.body->scale;
    deepest = std::max(deepest, sample.depth / volume.body->scale);
    if (sample.depth / volume.body->scale < .5 * kRadius) continue;
    EXPECT_LT(distance_to_axis(point_m), 2 * spacing_m + .02);
  }
  EXPECT_NEAR(deepest, kRadius, spacing_m + .01);
}

TEST(BodyVolumeTest, ThreadsDoNotChangeItAndItCanBeCancelled) {
  const TriangleMesh mesh = MakeCapsuleBody({{{0, 0, 0}, {1, 0, 0}, .3, .2}}, .06);
  const Topology topology = MakeTopology(mesh);
  const auto samples = [&](int num_threads) {
    return ComputeBodyVolume(topology, mesh.positions,
                             {.resolution = 40, .num_threads = num_threads})
        .value()
        .medial_samples;
  };
  const std::vector<MedialSample> one = samples(1), three = samples(3);
  ASSERT_EQ(one.size(), three.size());
  for (size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].position, three[i].position);
    EXPECT_EQ(one[i].depth, three[i].depth);
  }
  EXPECT_TRUE(absl::IsCancelled(
      ComputeBodyVolume(topology, mesh.positions, {}, Progress({}, [] { return true; })).status()));
}

TEST(BodyVolumeTest, RefusesWhatEnclosesNothing) {
  TriangleMesh sheet{Eigen::Matrix3Xd(3, 4), Eigen::Matrix3Xi(3, 2)};
  sheet.positions << 0, 1, 1, 0, 0, 0, 1, 1, 0, 0, 0, 0;
  sheet.triangles << 0, 0, 1, 2, 2, 3;
  EXPECT_THAT(ComputeBodyVolume(MakeTopology(sheet), sheet.positions),
              HasStatus(absl::StatusCode::kFailedPrecondition, HasSubstr("encloses no volume")));
  EXPECT_THAT(ComputeBodyVolume(MakeTopology(sheet), 0 * sheet.positions),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("area")));
}

}  // namespace
}  // namespace pleat
