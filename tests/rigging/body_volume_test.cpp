#include "pleat/rigging/body_volume.h"

#include <gtest/gtest.h>

#include "pleat/mesh/bounds.h"
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

TEST(BodyVolumeTest, RefusesWhatEnclosesNothing) {
  TriangleMesh sheet{Eigen::Matrix3Xd(3, 4), Eigen::Matrix3Xi(3, 2)};
  sheet.positions << 0, 1, 1, 0, 0, 0, 1, 1, 0, 0, 0, 0;
  sheet.triangles << 0, 0, 1, 2, 2, 3;
  EXPECT_THAT(ComputeBodyVolume(MakeTopology(sheet), sheet.positions),
              HasStatus(absl::StatusCode::kFailedPrecondition, HasSubstr("encloses no volume")));
}

}  // namespace
}  // namespace pleat
