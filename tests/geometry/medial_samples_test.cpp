#include "pleat/geometry/medial_samples.h"

#include <gtest/gtest.h>

#include "support/status_matchers.h"
#include "support/triangle_shapes.h"

namespace pleat {
namespace {

std::vector<MedialSample> SamplesOf(const TriangleMesh& mesh, int resolution,
                                    const MedialSampleOptions& options = {}) {
  const TriangleTree tree(mesh.positions, mesh.triangles);
  const WindingNumber winding_number(tree);
  DistanceFieldOptions field_options;
  field_options.resolution = resolution;
  return FindMedialSamples(*DistanceField::Compute(tree, winding_number, field_options), options);
}

TEST(MedialSamplesTest, SlabHasItsMiddlePlane) {
  MedialSampleOptions options;
  options.max_cosine = -.5;
  options.min_depth = .08;
  // .23 / 2 falls between two nodes: the samples must still lie on the middle plane.
  const std::vector<MedialSample> samples = SamplesOf(MakeBox({0, 0, 0}, {1, 1, .23}), 40, options);
  ASSERT_GT(samples.size(), 300u);
  for (const MedialSample& sample : samples) {
    EXPECT_NEAR(sample.position.z(), .115, 1e-3);
    EXPECT_NEAR(sample.depth, .115, 1e-3);
  }
}

TEST(MedialSamplesTest, CapsuleHasItsAxis) {
  const TriangleMesh mesh = MakeCapsuleBody({{{0, 0, 0}, {0, 2, 0}, .25, .25}}, .05);
  MedialSampleOptions options;
  options.min_depth = .1;  // facets leave shallow samples along convex edges
  const std::vector<MedialSample> samples = SamplesOf(mesh, 60, options);
  ASSERT_GT(samples.size(), 20u);
  double low = 9, high = -9;
  for (const MedialSample& sample : samples) {
    EXPECT_LT(std::hypot(sample.position.x(), sample.position.z()), .12);
    EXPECT_LE(sample.depth, .27);
    low = std::min(low, sample.position.y());
    high = std::max(high, sample.position.y());
  }
  EXPECT_NEAR(low, 0, .1);
  EXPECT_NEAR(high, 2, .1);
}

TEST(MedialSamplesTest, ShallowSamplesAreLeftOut) {
  MedialSampleOptions options;
  options.min_depth = .2;
  EXPECT_TRUE(SamplesOf(MakeBox({0, 0, 0}, {1, 1, .23}), 40, options).empty());
}

}  // namespace
}  // namespace pleat
