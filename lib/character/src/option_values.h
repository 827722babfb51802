// Options by name -> the types of the modules that act on them.
#pragma once

#include "pleat/character/train_options.h"
#include "pleat/fitting/details.h"
#include "pleat/skeleton/pose_features.h"

namespace pleat {

inline DetailAxes DetailAxesOf(const TrainOptions& options) {
  if (options.detail_axes == "world") return DetailAxes::kWorld;
  if (options.detail_axes == "root") return DetailAxes::kRoot;
  return DetailAxes::kLocal;
}

inline DetailBase DetailBaseOf(const TrainOptions& options) {
  return options.deformation == "full" ? DetailBase::kRoot : DetailBase::kSkinned;
}

inline RotationRepresentation RepresentationOf(const TrainOptions& options) {
  if (options.rotations == "euler") return RotationRepresentation::kEuler;
  if (options.rotations == "quaternion") return RotationRepresentation::kQuaternion;
  return RotationRepresentation::kExponentialMap;
}

inline PoseFeatureOptions FeatureOptionsOf(const TrainOptions& options) {
  return {.representation = RepresentationOf(options),
          .history = options.history,
          .differences = options.history_form == "differences"};
}

}  // namespace pleat
