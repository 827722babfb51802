#include "pleat/rigging/sphere_packing.h"

#include <gtest/gtest.h>

#include "pleat/base/random.h"

namespace pleat {
namespace {

std::vector<MedialSample> RandomSamples(int count) {
  Random random(9);
  std::vector<MedialSample> samples;
  for (int i = 0; i < count; ++i) {
    samples.push_back(
        {{random.Uniform(), random.Uniform(), random.Uniform()}, random.Uniform(.02, .2)});
  }
  return samples;
}

TEST(SpherePackingTest, CentersLieOutsideLargerSpheresAndEverySampleIsCovered) {
  const std::vector<MedialSample> samples = RandomSamples(2000);
  const std::vector<Sphere> spheres = PackSpheres(samples);
  ASSERT_GT(spheres.size(), 10u);
  for (size_t i = 0; i < spheres.size(); ++i) {
    for (size_t j = 0; j < i; ++j) {
      EXPECT_GE(spheres[j].radius, spheres[i].radius);
      EXPECT_GE((spheres[i].center - spheres[j].center).norm(), spheres[j].radius);
    }
  }
  for (const MedialSample& sample : samples) {
    bool is_covered = false;
    for (const Sphere& sphere : spheres) {
      is_covered |= (sphere.center - sample.position).norm() <= sphere.radius;
    }
    EXPECT_TRUE(is_covered);
  }
}

TEST(SpherePackingTest, KeepsTheLargestWithinTheLimit) {
  const std::vector<Sphere> all = PackSpheres(RandomSamples(500));
  const std::vector<Sphere> few = PackSpheres(RandomSamples(500), 5);
  ASSERT_EQ(few.size(), 5u);
  for (int i = 0; i < 5; ++i) EXPECT_EQ(few[i].center, all[i].center);
  EXPECT_TRUE(PackSpheres({}).empty());
}

}  // namespace
}  // namespace pleat
