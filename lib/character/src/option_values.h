// What the training options mean for the features of poses.
#pragma once

#include "pleat/character/train_options.h"
#include "pleat/skeleton/pose_features.h"

namespace pleat {

inline PoseFeatureOptions FeatureOptionsOf(const TrainOptions& options) {
  return {.representation = options.rotations,
          .history = options.history,
          .history_form = options.history_form};
}

}  // namespace pleat
