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
  const Eigen::AlignedBox3d box = ComputeBounds(volume.surface.positions);
  EXPECT_NEAR(box.sizes().maxCoeff(), .9, 1e-12);
  EXPECT_LT((box.center() - Eigen::Vector3d::Constant(.5)).norm(), 1e-9);
  const Eigen::Vector3d corner = volume.scale * Eigen::Vector3d(100, -20, 3) + volume.offset;
  EXPECT_LT((corner - box.min()).norm(), 1e-9);
  EXPECT_GT(volume.medial_samples.size(), 100u);
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
        volume.field.SignedDistance(volume.scale * point_m + volume.offset) / volume.scale;
    EXPECT_NEAR(found, distance_to_axis(point_m) - kRadius, .015);
  }
  const double spacing_m = volume.field.spacing() / volume.scale;
  double deepest = 0;
  for (const MedialSample& sample : volume.medial_samples) {
    const Eigen::Vector3d point_m = (sample.position - volume.offset) / volume.scale;
    deepest = std::max(deepest, sample.depth / volume.scale);
    if (sample.depth / volume.scale < .5 * kRadius) continue;
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
