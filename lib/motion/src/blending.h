// Small formulas that several edits share.
#pragma once

#include <algorithm>
#include <numbers>

namespace pleat {

inline constexpr double kDegree = std::numbers::pi / 180;  // in radians

// Rises from 0 to 1 while u does, with no slope at either end; constant outside.
inline double SmoothStep(double u) {
  u = std::clamp(u, 0., 1.);
  return u * u * (3 - 2 * u);
}

}  // namespace pleat
