// The regions of the body for the regional learner, one for each bone
// (docs/method/learner.md#regions).
#pragma once

#include <vector>

#include "pleat/character/skin_features.h"
#include "pleat/character/train_options.h"
#include "pleat/learner/detail_model.h"
#include "pleat/skinning/rig.h"

namespace pleat {

// Returns one region for each bone that moves a vertex of `control_vertices` (C). Its weights (3C)
// are the skinning weights. Its feature sets are, from wide to narrow, those of all bones, of the
// bones within one bone of it, and its own.
std::vector<DetailRegion> DetailRegions(const Rig& rig, const std::vector<int>& control_vertices,
                                        const TrainOptions& options);

// Returns the bones of these regions, in their order.
std::vector<int> RegionBones(const Rig& rig, const std::vector<int>& control_vertices);

// Adds to each region the set of its own features of the skin, which stand in the columns from
// `first_column` on. `features` must have been trained for these regions (asserted).
void AddSkinFeatureSets(const SkinFeatures& features, int first_column,
                        std::vector<DetailRegion>* regions);

// Returns the columns of the features in groups that share one learned relevance: the columns of
// one joint in one pose of the history.
std::vector<std::vector<int>> FeatureGroups(int num_joints, const TrainOptions& options);

}  // namespace pleat
