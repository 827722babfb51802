// The regions of the body for the regional learner (docs/method/learner.md#regions): one for each
// bone, and patches of the surface that do not ask how the bones divide it.
#pragma once

#include <set>
#include <vector>

#include "pleat/skinning/rig.h"

namespace pleat {

struct BodyRegion {
  std::vector<int> vertices;   // that it has a share in, ascending
  std::vector<float> weights;  // the share of each; over all regions of a kind they sum to 1
  std::set<int> bones;         // that move it
  int max_components = 0;      // of its basis
  int max_skin_features = 0;
};

// Returns one region for each bone that moves a vertex of `control_vertices`; the shares are the
// skinning weights.
std::vector<BodyRegion> BoneRegions(const Rig& rig, const std::vector<int>& control_vertices);

// Returns about `count` patches of vertices that are near each other and move alike: soft k-means
// over rest positions and skinning weights. A vertex has a share in at most four. Patches without a
// vertex of `control_vertices` are left out. Deterministic.
std::vector<BodyRegion> PatchRegions(const Rig& rig, const std::vector<int>& control_vertices,
                                     int count);

}  // namespace pleat
