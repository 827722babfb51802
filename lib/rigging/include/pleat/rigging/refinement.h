// Step 9 of the embedding: joints moved continuously from the path of spheres to the middle of the
// limbs.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "pleat/geometry/medial_samples.h"

namespace pleat {

// Weights of method.md, 2.2, step 9 (unit box lengths).
struct RefinementOptions {
  double centring = 15000;  // squared distance of the bone to the medial surface, mean over it
  double length = .25;      // relative deviation from the template's length
  // The same for the bones across the trunk, from hips and chest to the limbs: the surface says
  // nothing about their length, under a skirt least of all.
  double trunk_length = 30;
  double angle = 5;     // 1 - cosine to the template's direction; 2 leaves hips in skirts worse
  double symmetry = 1;  // relative difference of mirrored lengths
  int samples_per_bone = 10;
  int max_iterations = 60;
};

// Minimises the weighted sum over the bones of the human template by Levenberg-Marquardt, the
// nearest medial samples kept fixed within a step (Baran and Popovic 2007, section 3.4). joints:
// start, 3 x 18 in template order, unit box. template_joints: 3 x 18, turned by the yaw and of the
// body's size. Returns the refined joints.
Eigen::Matrix3Xd RefineEmbedding(const Eigen::Matrix3Xd& joints,
                                 const Eigen::Matrix3Xd& template_joints,
                                 const std::vector<MedialSample>& medial_samples,
                                 const RefinementOptions& options = {});

}  // namespace pleat
