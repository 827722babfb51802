// What the regional learner sees of the regions of the body (docs/method/learner.md#regions).
#pragma once

#include <vector>

#include "body_regions.h"
#include "pleat/character/skin_features.h"
#include "pleat/character/train_options.h"
#include "pleat/learner/detail_model.h"
#include "pleat/skeleton/skeleton.h"

namespace pleat {

// Returns what the learner needs to know of these regions. Their weights are the shares of the
// details of `control_vertices` (C; 3C rows), times `share`, by which several kinds of regions have
// their part in the prediction. The feature sets are, from wide to narrow, those of all bones, of
// the bones within one bone of the region's, and of its own.
std::vector<DetailRegion> DetailRegions(const std::vector<BodyRegion>& body,
                                        const Skeleton& skeleton,
                                        const std::vector<int>& control_vertices, double share,
                                        const TrainOptions& options);

// Adds to each region the set of its own features of the skin, which stand in the columns from
// `first_column` on. `features` must have been trained for these regions (asserted).
void AddSkinFeatureSets(const SkinFeatures& features, int first_column,
                        std::vector<DetailRegion>* regions);

// Returns the columns of the features in groups that share one learned relevance: the columns of
// one joint in one pose of the history.
std::vector<std::vector<int>> FeatureGroups(int num_joints, const TrainOptions& options);

}  // namespace pleat
