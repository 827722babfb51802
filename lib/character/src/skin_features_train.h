// The training of SkinFeatures.
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "body_regions.h"
#include "pleat/character/skin_features.h"
#include "pleat/mesh/topology.h"

namespace pleat {

struct SkinFeaturesOptions {
  int num_points = 400;
  double smallest_weight = .02;  // of an edge, for it to count in a region
  // Components are divided by this power of their deviation: weaker ones say more than their size.
  double whitening = .25;
  int max_frames = 1000;  // that the components are learned from, spread evenly
  int num_threads = 0;
};

// Learns the features of each region (max_skin_features components) from the poses of the training.
// Deterministic, whatever the number of threads.
absl::StatusOr<SkinFeatures> TrainSkinFeatures(const Topology& topology, const Rig& rig,
                                               const PoseTrack& track,
                                               const std::vector<BodyRegion>& regions,
                                               const SkinFeaturesOptions& options = {});

}  // namespace pleat
