// Makes a rig that explains an animation better than the first one
// (docs/method/fit.md#rig-refinement): poses, rest joints, skinning weights and rest mesh in turn,
// each step with all else held.
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "pleat/base/progress.h"
#include "pleat/mesh/mesh_sequence.h"
#include "pleat/skeleton/pose_track.h"
#include "pleat/skinning/rig.h"

namespace pleat {

struct RigRefinementOptions {
  bool joints = true;                // move the rest joints
  bool weights = true;               // solve the skinning weights anew
  bool rest = true;                  // move the rest mesh
  std::vector<int> locked_joints{};  // these stay where they are

  // A pull of every joint to its place in the first rig, as a share of the mean curvature of the
  // error per joint. Without it joints that the motion hardly shows run away (knees under a skirt
  // by 26-32 cm); from .3 on known joints come out no worse than they were (docs/performance.md).
  double joint_prior = 0.3;
  // Pulls of a vertex's weights to the mean of its neighbors' and to the first rig's, in units of
  // the body's mean squared size.
  double weight_smoothness = 1e-2;
  double weight_prior = 3e-4;
  // Pulls of a vertex's displacement to the mean of its neighbors' and to none, as shares of the
  // pull of the vertex's own observations.
  double rest_smoothness = 1;
  double rest_prior = 0.1;

  int num_rounds = 5;
  int max_influences = kStandardInfluences;  // bones of a vertex, 1..kMaxInfluences
  int max_frames = 400;                      // evenly spaced ones are used of a longer sequence
  int max_iterations = 20;                   // limit of the pose solver, per frame and step
  double bend_stiffness = 1e-6;              // as in PoseFitOptions
  int num_threads = 0;                       // 0 = one per core; the result does not depend on it

  // Options for joints alone, which are held harder, since they are all that can follow cloth.
  static RigRefinementOptions JointsOnly() {
    return {.weights = false, .rest = false, .joint_prior = 1};
  }
};

struct RigRefinementSummary {
  std::vector<double> round_rms_m;    // error at the start of every round, its poses solved
  double rms_m = 0;                   // with the refined rig
  std::vector<double> joint_moved_m;  // per joint: distance from the first rig
  double mean_weight_change = 0;      // mean over vertices of half the sum of |new - old|: 0..1
  double rest_moved_m = 0;            // RMS over vertices
};

// Returns the refined rig; fit the poses again with it. `track` holds the poses of all frames,
// fitted with `rig` (FitPoses). Leaves of the skeleton have no influence on the mesh and stay. A
// vertex keeps at most max_influences bones: bones of its own, of its neighbors, or next to its own
// in the skeleton. The result does not depend on the number of threads.
//
// The error is kInvalidArgument when rig, track and sequence do not belong together or an option is
// out of range, and kCancelled. `summary` may be null.
absl::StatusOr<Rig> RefineRig(const MeshSequence& sequence, const Rig& rig, const PoseTrack& track,
                              const RigRefinementOptions& options, RigRefinementSummary* summary,
                              const Progress& progress = {});

}  // namespace pleat
