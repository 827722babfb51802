// Step 4 of the embedding: a few large inscribed spheres that fill the body.
#pragma once

#include <vector>

#include "pleat/geometry/medial_samples.h"

namespace pleat {

struct Sphere {
  Eigen::Vector3d center;
  double radius;
};

// Packs the inscribed spheres of `samples` greedily, largest first; a sphere is taken when its
// center lies outside of all taken before (Baran and Popovic 2007, section 3.1). Returns them by
// falling radius.
std::vector<Sphere> PackSpheres(std::vector<MedialSample> samples, int max_spheres = 1000);

}  // namespace pleat
