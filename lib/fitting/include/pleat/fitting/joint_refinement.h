// Rest joints that explain an animation better than the first rig's (method.md, 3.3).
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "pleat/base/progress.h"
#include "pleat/mesh/mesh_sequence.h"
#include "pleat/skinning/rig.h"

namespace pleat {

struct JointRefinementOptions {
  // Pull of every joint to its place in the first rig, as a share of the mean curvature of the
  // error per joint. Without it joints that the motion hardly shows run away (knees under a skirt
  // by 26-32 cm); .05 to .2 keeps nearly all of the gain.
  double prior = 0.1;
  int num_rounds = 5;       // of poses, then joints
  int max_frames = 200;     // evenly spaced ones are used of a longer sequence
  int max_iterations = 20;  // of the pose solver, per frame and round
  int num_threads = 0;      // 0 = one per core; the result does not depend on it
};

struct JointRefinementSummary {
  std::vector<double> round_rms_m;  // error of the poses of every round, before its joints moved
  double rms_m = 0;                 // with the refined joints
  std::vector<double> moved_m;      // per joint: distance from the first rig
};

// Alternates between the poses of all frames and the rest positions of all joints that have
// children, each joint step a linear least-squares problem in the moments of method.md, 3.2 (the
// frames' root positions are eliminated). Leaves have no influence on the mesh and stay. Weights
// and rest mesh stay. kInvalidArgument when rig and sequence differ in vertices or an option is
// out of range; kCancelled. `summary` may be null.
absl::StatusOr<Rig> RefineJoints(const MeshSequence& sequence, const Rig& rig,
                                 const JointRefinementOptions& options,
                                 JointRefinementSummary* summary, const Progress& progress = {});

}  // namespace pleat
