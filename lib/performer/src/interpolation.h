// Scalar interpolation shared by shape, motion and skirt.
#pragma once

#include <algorithm>

namespace pleat {

// Returns 0 below `low`, 1 above `high`, and between a cubic with zero slopes at both ends.
inline double Smoothstep(double low, double high, double x) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

}  // namespace pleat
