// By how much each foot must move so that it stands where it stands.
#pragma once

#include <Eigen/Core>

#include "pleat/math/clip_starts.h"
#include "pleat/motion/clean_feet.h"

namespace pleat {

struct FootHeights {
  double ankle = 0, toes = 0;  // of a foot that stands flat, meters in the world
};

// 3 x T, meters, of which the frames of `clip` are set.
void AddFootMoves(const FootPath& path, const FootContacts& contacts, const FootHeights& heights,
                  const ClipRange& clip, double fps, const CleanFeetOptions& options,
                  Eigen::Matrix3Xd* moves);

}  // namespace pleat
