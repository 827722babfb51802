// Finds what of a volume is the character: the input of the embedding's search, stood upright.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "pleat/rigging/body_volume.h"
#include "pleat/rigging/sphere_graph.h"

namespace pleat {

// The character, everything in the unit box, turned by the rotation that stands it upright.
struct MainBody {
  SphereGraph graph;  // the spheres that hang together and hold the most volume
  std::vector<MedialSample> medial_samples;
  Eigen::Matrix3Xd positions;  // 3 x W, of volume.surface
  std::vector<char> is_body;   // per mesh component: false for what floats beside the character
  Eigen::AlignedBox3d bounds;  // box of the components that are body
};

// Packs the spheres, connects them and keeps the group of spheres with the largest volume. The
// field stays in the axes of the input: edges are found before the spheres are turned.
MainBody FindMainBody(const BodyVolume& volume, int max_spheres,
                      const Eigen::Matrix3d& upright_from_input);

}  // namespace pleat
