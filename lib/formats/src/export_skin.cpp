#include "export_skin.h"

#include <algorithm>
#include <cmath>

namespace pleat {
namespace {

// glTF's validator asks for sums that are this near to 1. Weights that are stay as they are.
constexpr double kSumTolerance = 1e-7;

}  // namespace

std::vector<ExportInfluences> MakeExportInfluences(const SkinWeights& weights,
                                                   const std::vector<ExportJoint>& joints) {
  const std::vector<int> turning = TurningJoints(joints);
  std::vector<ExportInfluences> influences;
  influences.reserve(static_cast<size_t>(weights.num_vertices()));
  for (const VertexInfluences& vertex : weights.influences()) {
    ExportInfluences& written = influences.emplace_back();
    double sum = 0;
    for (const float weight : vertex.weights) sum += weight;
    const bool is_exact = std::abs(sum - 1) <= kSumTolerance;
    for (size_t k = 0; k < kMaxInfluences && vertex.weights[k] > 0; ++k) {
      written.joints[k] = static_cast<uint16_t>(turning[vertex.bones[k]]);
      written.weights[k] =
          is_exact ? vertex.weights[k] : static_cast<float>(vertex.weights[k] / sum);
    }
  }
  return influences;
}

int MostInfluences(const SkinWeights& weights) {
  int most = 0;
  for (const VertexInfluences& vertex : weights.influences()) {
    const auto count = std::ranges::count_if(vertex.weights, [](float w) { return w > 0; });
    most = std::max(most, static_cast<int>(count));
  }
  return most;
}

}  // namespace pleat
