// Samples of the approximate medial surface of a volume (docs/method/rig.md#medial-samples).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "pleat/geometry/distance_field.h"

namespace pleat {

struct MedialSample {
  Eigen::Vector3d position;
  double depth;  // distance to the surface: the radius of the inscribed sphere
};

struct MedialSampleOptions {
  double min_depth = 0;   // shallower points are left out (fingers, cloth)
  double max_cosine = 0;  // the directions to the surface disagree by at least this angle: 90 deg
};

// Returns points between two neighboring grid nodes whose directions to the nearest surface
// disagree (Baran and Popovic 2007, section 3.1), placed where the two distances meet, in grid
// order.
std::vector<MedialSample> FindMedialSamples(const DistanceField& field,
                                            const MedialSampleOptions& options = {});

}  // namespace pleat
