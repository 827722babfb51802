#include "pleat/rigging/sphere_packing.h"

#include <algorithm>

namespace pleat {

std::vector<Sphere> PackSpheres(std::vector<MedialSample> samples, int max_spheres) {
  std::stable_sort(samples.begin(), samples.end(),
                   [](const MedialSample& a, const MedialSample& b) { return a.depth > b.depth; });
  std::vector<Sphere> spheres;
  for (const MedialSample& sample : samples) {
    if (static_cast<int>(spheres.size()) >= max_spheres) break;
    // Quadratic, but spheres are few: a person takes 30 to 210, whatever the number of samples.
    const bool is_covered = std::any_of(spheres.begin(), spheres.end(), [&](const Sphere& sphere) {
      return (sphere.center - sample.position).squaredNorm() < sphere.radius * sphere.radius;
    });
    if (!is_covered) spheres.push_back({sample.position, sample.depth});
  }
  return spheres;
}

}  // namespace pleat
