// The input of the embedding's search, stood upright.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "pleat/rigging/body_volume.h"
#include "pleat/rigging/sphere_graph.h"

namespace pleat {

// The character, everything in the unit box, turned by the rotation that stands it upright.
struct MainBody {
  SphereGraph graph;
  std::vector<MedialSample> medial_samples;
  BodyShell shell;
  Eigen::AlignedBox3d bounds;  // of the shell
};

// Turns what the volume holds.
MainBody FindMainBody(const BodyVolume& volume, const Eigen::Matrix3d& upright_from_input);

// Returns the angle about +y (in [0, pi)) by which a template must be turned so that its left
// points along the horizontal principal axis of the shell, stood up by `upright_from_shell`.
double HorizontalAxisYaw(const BodyShell& shell, const Eigen::Matrix3d& upright_from_shell);

}  // namespace pleat
