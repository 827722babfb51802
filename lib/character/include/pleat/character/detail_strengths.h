// How strong the learned detail is shown (docs/method/motion.md#strength-of-the-detail).
#pragma once

#include <vector>

#include "absl/status/status.h"
#include "pleat/character/character_model.h"

namespace pleat {

inline constexpr double kMaxDetailStrength = 2;

// Factors from 0 (skinned only) to kMaxDetailStrength; 1 is what was learned.
struct DetailStrengths {
  std::vector<double> joints{};   // J, by the bones that move a vertex, or empty; [0] is not used
  std::vector<float> vertices{};  // V, painted on the vertices, or empty

  bool empty() const { return joints.empty() && vertices.empty(); }
};

// kInvalidArgument names a wrong count, or the first factor that is out of range.
absl::Status CheckDetailStrengths(const DetailStrengths& strengths, int num_joints,
                                  int num_vertices);

// The factor of every lane of every block of the model's basis: that painted on its vertex, times
// the mean of those of its bones by their weights. The strengths must fit the model (asserted).
std::vector<float> LaneStrengths(const CharacterModel& model, const DetailStrengths& strengths);

}  // namespace pleat
