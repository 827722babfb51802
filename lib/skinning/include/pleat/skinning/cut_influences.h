// Fewer bones per vertex, for programs that take no more, and what that costs.
#pragma once

#include "pleat/skeleton/pose_track.h"
#include "pleat/skinning/rig.h"
#include "pleat/skinning/skin_weights.h"

namespace pleat {

// Keeps the strongest `max_influences` (1 to kMaxInfluences, asserted) of every vertex, normalized.
// Vertices that have no more stay as they are, bit for bit.
SkinWeights CutInfluences(const SkinWeights& weights, int max_influences);

// How far the skinned vertices of all poses move because of other weights.
struct InfluenceCutError {
  double rms_m = 0, max_m = 0;
  int num_vertices = 0;  // whose weights differ
  int worst_frame = 0, worst_vertex = 0;
};
// other: of the vertices of the rig. `track` must have the joints of the rig (asserted).
InfluenceCutError MeasureInfluenceCut(const Rig& rig, const SkinWeights& other,
                                      const PoseTrack& track);

}  // namespace pleat
