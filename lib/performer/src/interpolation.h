// Scalar interpolation shared by shape, motion and skirt.
#pragma once

#include <algorithm>

namespace pleat {

// 0 below `low`, 1 above `high`, cubic with zero end slopes between.
inline double Smoothstep(double low, double high, double x) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

}  // namespace pleat
