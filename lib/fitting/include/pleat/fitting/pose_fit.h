// Fits the pose of a rig in every frame of a sequence (docs/method/fit.md; paper, section III-B).
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "pleat/base/progress.h"
#include "pleat/mesh/mesh_sequence.h"
#include "pleat/skeleton/pose_track.h"
#include "pleat/skinning/rig.h"

namespace pleat {

enum class PoseFitMethod {
  kAllJoints,  // all joints at once, Levenberg-Marquardt: 2-4 times less error than the walk
  kWalk,       // the paper's: joint after joint from the root to the leaves, from the last frame
};

struct PoseFitOptions {
  PoseFitMethod method = PoseFitMethod::kAllJoints;
  // kAllJoints: at most this many linear systems per start; 5-15 are typical.
  int max_iterations = 60;
  // kAllJoints: stop when a step lowers the energy by less than this share of it. 1e-5 and 1e-9
  // give the same error to four digits on captured sequences.
  double tolerance = 1e-5;
  // kAllJoints: how often every frame also tries the solutions of its neighbors in time as a start,
  // which frees frames that the closed-form start left in a wrong valley. 0 = never.
  int neighbor_passes = 2;
  // A pull of every bone towards its parent's rotation, as a share of the mean Gram diagonal per
  // bone. It decides only what the vertices do not: the twist of a thin bone, a bone without
  // vertices. The error of the fit does not change measurably up to 1e-3.
  double bend_stiffness = 1e-6;
  // kAllJoints: a pull towards the neighbors' rotations in time, in the same unit; 1e-2 cuts jitter
  // by a quarter to a half for under .05 % more error. 0 = off, frames are independent.
  double smoothness = 0;
  // The first frame of every clip, ascending; the first is 0. Starts and smoothness stay inside a
  // clip.
  std::vector<int> clip_starts{0};
  int num_threads = 0;  // 0 = one per core; the result does not depend on it
};

struct PoseFitSummary {
  std::vector<double> frame_rms_m;  // per frame: root mean squared vertex distance, meters
  double rms_m = 0;                 // over all frames
  std::vector<int> worst_frames;    // up to five, largest error first
  double mean_iterations = 0;       // linear systems (or walk sweeps) per frame
  int num_rescued_frames = 0;       // frames that a neighbor's start improved
  double jitter_rad = 0;            // RotationJitter of the track
  // The values that smoothing started from; the same as above without it.
  double unsmoothed_rms_m = 0;
  double unsmoothed_jitter_rad = 0;
};

// Fits rig.skeleton to every frame of `sequence`. The rest pose and the joints stay as they are.
// The root's rotation, which has no influence on the mesh, is set to the mean of the bones at the
// hips (FixRootGauge). Quaternions keep their sign from frame to frame within a clip (the angle
// between consecutive ones is at most 90 degrees in four dimensions), so that curves over their
// entries or over unwrapped angles have no jumps. The result does not depend on the number of
// threads.
//
// The error is kInvalidArgument when the vertex counts of rig and sequence differ or clip_starts do
// not ascend from 0, and kCancelled. `summary` may be null.
absl::StatusOr<PoseTrack> FitPoses(const MeshSequence& sequence, const Rig& rig,
                                   const PoseFitOptions& options, PoseFitSummary* summary,
                                   const Progress& progress = {});

// Returns how much rotations shake, in radians: the RMS over joints and frames of the angle between
// a frame's turn since the frame before and the turn that follows (the second difference in time).
// Clips are looked at separately; 0 when no clip has three frames.
double RotationJitter(const PoseTrack& track);

// Sets the root's world rotation to the mean rotation of the bones from the root to leftUpperLeg
// and rightUpperLeg (of all children of the root where those names are missing) and re-expresses
// the children: every other bone keeps its world motion, and the mesh does not change
// (docs/method/fit.md#gauge).
void FixRootGauge(const Skeleton& skeleton, Pose* pose);

}  // namespace pleat
