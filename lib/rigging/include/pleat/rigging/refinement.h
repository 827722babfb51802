// Step 9 of the embedding: moves joints continuously from the path of spheres to the middle of the
// limbs.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "pleat/geometry/medial_samples.h"

namespace pleat {

// The weights of docs/method/rig.md#refinement (unit box lengths), and what measuring added to it.
struct RefinementOptions {
  // The squared distance of the bone to the medial surface, across the bone and mean over it. Along
  // the bone only leaves are held: a knee may slide to where the leg's proportions want it.
  double centering = 15000;
  // Where the medial surface lies deeper than this (about a limb's radius) its pull falls with the
  // square of the depth: the middle of a skirt says little about a thigh.
  double limb_radius = .03;
  // Thigh to lower leg, and legs to the trunk between hips and shoulders: of all lengths these vary
  // least among people (Drillis and Contini 1966), and under clothes the surface does not show
  // them. Relative deviations, in units of the template's leg.
  double proportions = 100;
  double length = .25;  // relative deviation from the template's length
  // The same weight for the bones across the trunk, from hips and chest to the limbs: the surface
  // says nothing about their length, under a skirt least of all.
  double trunk_length = 30;
  double angle = 5;     // 1 - cosine to the template's direction; 2 leaves hips in skirts worse
  double symmetry = 1;  // relative difference of mirrored lengths
  int samples_per_bone = 10;
  int max_iterations = 60;
  std::vector<int> held_joints = {};  // stay where they are
  // The mean height of the hips of the legs, where it is known: it takes the place of the
  // proportion of the legs to the trunk. Unit box, along y.
  std::optional<double> hip_height = {};
};

// Minimizes the weighted sum over the bones of the human template by Levenberg-Marquardt, with the
// nearest medial samples kept fixed within a step (Baran and Popovic 2007, section 3.4). joints:
// the start, 3 x 18 in template order, unit box. template_joints: 3 x 18, turned by the yaw and of
// the body's size. Returns the refined joints, whose energy is never above that of the start.
Eigen::Matrix3Xd RefineEmbedding(const Eigen::Matrix3Xd& joints,
                                 const Eigen::Matrix3Xd& template_joints,
                                 const std::vector<MedialSample>& medial_samples,
                                 const RefinementOptions& options = {});

}  // namespace pleat
