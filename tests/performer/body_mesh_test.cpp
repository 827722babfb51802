#include "body_mesh.h"

#include <gtest/gtest.h>

#include "performer/soup_checks.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

TEST(BodyMeshTest, IsAClosedSphereOfAboutTheWantedSizeOnTheSurface) {
  const CharacterShape shape(1);
  for (const int wanted : {800, 2500}) {
    PLEAT_ASSERT_OK_AND_ASSIGN(const TriangleSoup mesh, BuildBodyMesh(shape, wanted, {}));
    EXPECT_TRUE(IsClosedManifold(mesh));
    EXPECT_EQ(EulerCharacteristic(mesh), 2);
    EXPECT_GT(Volume(mesh), 0);
    EXPECT_NEAR(static_cast<double>(mesh.positions.size()), wanted, .06 * wanted);
    double worst = 0;
    for (const Eigen::Vector3d& p : mesh.positions) {
      worst = std::max(worst, std::abs(shape.Distance(p)));
    }
    EXPECT_LT(worst, .02) << wanted;
  }
}

TEST(BodyMeshTest, CancellationIsHeard) {
  EXPECT_THAT(BuildBodyMesh(CharacterShape(1), 800, Progress(nullptr, [] { return true; })),
              HasStatus(absl::StatusCode::kCancelled, testing::_));
}

}  // namespace
}  // namespace pleat
