// How much each vertex counts in a pose fit (docs/method/fit.md#fit-weights).
#pragma once

#include <Eigen/Core>

#include "pleat/mesh/mesh_sequence.h"
#include "pleat/skeleton/pose_track.h"
#include "pleat/skinning/rig.h"

namespace pleat {

// Returns the weights (V, mean 1) for Rig::fit_weights: the less a vertex follows its bones, the
// less it counts. Empty when every vertex follows them exactly. The sequence, the rig and the poses
// of its frames must belong together. At most max_frames frames are used, spread evenly. The result
// does not depend on the number of threads.
Eigen::VectorXf ComputeFitWeights(const MeshSequence& sequence, const Rig& rig,
                                  const PoseTrack& track, int num_threads, int max_frames = 400);

}  // namespace pleat
