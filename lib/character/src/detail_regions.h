// The regions of the body for the regional learner, one for each bone
// (docs/method/learner.md#regions).
#pragma once

#include <vector>

#include "pleat/character/train_options.h"
#include "pleat/learner/detail_model.h"
#include "pleat/skinning/rig.h"

namespace pleat {

// Returns one region for each bone that moves a vertex of `control_vertices` (C). Its weights (3C)
// are the skinning weights. Its three feature sets are, from wide to narrow, all features, those of
// the bones within two bones of it, and those of the bones within one.
std::vector<DetailRegion> DetailRegions(const Rig& rig, const std::vector<int>& control_vertices,
                                        const TrainOptions& options);

// Returns the columns of the features in groups that share one learned relevance: the columns of
// one joint in one pose of the history.
std::vector<std::vector<int>> FeatureGroups(int num_joints, const TrainOptions& options);

}  // namespace pleat
