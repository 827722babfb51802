// How far two sequences are apart.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>

#include "pleat/mesh/mesh_sequence.h"

namespace pleat {

// Largest coordinate difference, meters.
inline double LargestDifference(const MeshSequence& a, const MeshSequence& b) {
  double largest = 0;
  for (int t = 0; t < a.num_frames(); ++t) {
    largest = std::max<double>(largest, (a.frame(t) - b.frame(t)).cwiseAbs().maxCoeff());
  }
  return largest;
}

}  // namespace pleat
