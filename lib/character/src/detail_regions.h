// The body regions of the regional learner: one for each bone (docs/method/learner.md#regions).
#pragma once

#include <vector>

#include "pleat/character/train_options.h"
#include "pleat/learner/detail_model.h"
#include "pleat/skinning/rig.h"

namespace pleat {

// One region for each bone that moves a vertex of `control_vertices` (C): its weights are the
// skinning weights, its feature sets all features, those of the bones within two bones of it, and
// those within one.
std::vector<DetailRegion> DetailRegions(const Rig& rig, const std::vector<int>& control_vertices,
                                        const TrainOptions& options);

// The columns of the features in groups whose relevance is learned as one: those of a joint in one
// pose of the history.
std::vector<std::vector<int>> FeatureGroups(int num_joints, const TrainOptions& options);

}  // namespace pleat
