// Skinning weights as the joints of other programs have them.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pleat/formats/joint_clip.h"
#include "pleat/skinning/skin_weights.h"

namespace pleat {

// The influences of one vertex: export joints, and weights that add up to 1 as exactly as float32
// can; unused ones are 0.
struct ExportInfluences {
  std::array<uint16_t, kMaxInfluences> joints{};
  std::array<float, kMaxInfluences> weights{};
};

std::vector<ExportInfluences> MakeExportInfluences(const SkinWeights& weights,
                                                   const std::vector<ExportJoint>& joints);
// The largest number of influences that a vertex has.
int MostInfluences(const SkinWeights& weights);

}  // namespace pleat
