#include "remesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "performer/soup_checks.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using Eigen::Vector3d;

const Vector3d kBoxLow(-1.6, -1.6, -1.6), kBoxHigh(1.6, 1.6, 1.6);

std::vector<double> EdgeLengths(const TriangleSoup& soup) {
  std::vector<double> lengths;
  for (const auto& t : soup.triangles) {
    for (int c = 0; c < 3; ++c) {
      if (t[c] < t[(c + 1) % 3]) {
        lengths.push_back((soup.positions[t[c]] - soup.positions[t[(c + 1) % 3]]).norm());
      }
    }
  }
  return lengths;
}

struct Case {
  double (*distance)(const Vector3d&);
  int characteristic;
};

TEST(RemeshTest, EdgesComeNearTheWantedLengthAndTheSurfaceStays) {
  for (const auto& [distance, characteristic] : {Case{Sphere, 2}, Case{Torus, 0}}) {
    const TriangleSoup soup = ExtractIsosurface(distance, kBoxLow, kBoxHigh, .12, {}).value();
    for (const double wanted : {.08, .2}) {
      PLEAT_ASSERT_OK_AND_ASSIGN(
          const TriangleSoup remeshed,
          RemeshIsotropic(
              soup, {.distance = distance, .edge_length = [&](const Vector3d&) { return wanted; }},
              {}));
      EXPECT_TRUE(IsClosedManifold(remeshed));
      EXPECT_EQ(EulerCharacteristic(remeshed), characteristic);
      EXPECT_NEAR(Volume(remeshed), Volume(soup), .08 * Volume(soup));
      double sum = 0;
      const std::vector<double> lengths = EdgeLengths(remeshed);
      for (const double length : lengths) {
        sum += length;
        EXPECT_LT(length, 2 * wanted);
      }
      EXPECT_NEAR(sum / static_cast<double>(lengths.size()), wanted, .2 * wanted);
      for (const Vector3d& p : remeshed.positions) EXPECT_NEAR(distance(p), 0, .1 * wanted);
    }
  }
}

TEST(RemeshTest, FinerWhereFinerIsWanted) {
  const TriangleSoup soup = ExtractIsosurface(Sphere, kBoxLow, kBoxHigh, .12, {}).value();
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const TriangleSoup remeshed,
      RemeshIsotropic(soup,
                      {.distance = Sphere,
                       .edge_length = [](const Vector3d& p) { return p.y() > 0 ? .08 : .2; }},
                      {}));
  EXPECT_TRUE(IsClosedManifold(remeshed));
  const auto above = std::count_if(remeshed.positions.begin(), remeshed.positions.end(),
                                   [](const Vector3d& p) { return p.y() > 0; });
  EXPECT_GT(above, 3 * (static_cast<long>(remeshed.positions.size()) - above));
}

TEST(RemeshTest, TheResultIsTheSameEveryTimeAndCancellationIsHeard) {
  const TriangleSoup soup = ExtractIsosurface(Sphere, kBoxLow, kBoxHigh, .2, {}).value();
  const RemeshOptions options{.distance = Sphere,
                              .edge_length = [](const Vector3d&) { return .15; }};
  const TriangleSoup a = RemeshIsotropic(soup, options, {}).value();
  const TriangleSoup b = RemeshIsotropic(soup, options, {}).value();
  EXPECT_EQ(a.positions, b.positions);
  EXPECT_EQ(a.triangles, b.triangles);
  EXPECT_THAT(RemeshIsotropic(soup, options, Progress(nullptr, [] { return true; })),
              HasStatus(absl::StatusCode::kCancelled, testing::_));
}

}  // namespace
}  // namespace pleat
