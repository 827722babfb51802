// Procedural motion of the human template.
#pragma once

#include "pleat/performer/performer.h"
#include "pleat/skeleton/skeleton.h"

namespace pleat {

struct MotionOptions {
  uint64_t seed = 1;
  PerformerStyle style = PerformerStyle::kDance;
  int num_frames = 200;
  double fps = 30;
};

// Generates a motion of `skeleton` (human template, units of body height, facing +z, floor y = 0)
// that begins in the rest pose. The feet stand on the floor without sliding except in jumps. The
// first frames do not depend on num_frames.
PoseTrack GenerateMotion(const Skeleton& skeleton, const MotionOptions& options);

}  // namespace pleat
