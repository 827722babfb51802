#include "pleat/character/detail_strengths.h"

#include <cassert>

#include "absl/strings/str_cat.h"

namespace pleat {
namespace {

template <typename Factor>
absl::Status CheckFactors(const std::vector<Factor>& factors, int count, const char* what) {
  if (factors.empty()) return absl::OkStatus();
  if (static_cast<int64_t>(factors.size()) != count) {
    return absl::InvalidArgumentError(absl::StrCat(factors.size(), " detail strengths for ", count,
                                                   " of kind ", what, "; give all or none"));
  }
  for (size_t i = 0; i < factors.size(); ++i) {
    if (factors[i] >= 0 && factors[i] <= Factor{kMaxDetailStrength}) continue;
    return absl::InvalidArgumentError(absl::StrCat("detail strength ", factors[i], " of ", what,
                                                   " ", i, " is outside 0 to ",
                                                   kMaxDetailStrength));
  }
  return absl::OkStatus();
}

double StrengthOf(const CharacterModel& model, const DetailStrengths& strengths, int v) {
  double strength = strengths.vertices.empty() ? 1 : strengths.vertices[static_cast<size_t>(v)];
  if (strengths.joints.empty()) return strength;
  const VertexInfluences& influences = model.rig().weights.vertex(v);
  double mean = 0, sum = 0;
  for (size_t i = 0; i < influences.bones.size(); ++i) {
    mean += influences.weights[i] * strengths.joints[influences.bones[i]];
    sum += influences.weights[i];
  }
  return sum > 0 ? strength * mean / sum : strength;
}

}  // namespace

absl::Status CheckDetailStrengths(const DetailStrengths& strengths, int num_joints,
                                  int num_vertices) {
  absl::Status status = CheckFactors(strengths.joints, num_joints, "joint");
  status.Update(CheckFactors(strengths.vertices, num_vertices, "vertex"));
  return status;
}

std::vector<float> LaneStrengths(const CharacterModel& model, const DetailStrengths& strengths) {
  assert(CheckDetailStrengths(strengths, model.skeleton().num_joints(), model.num_vertices()).ok());
  const PartedBasis& basis = model.full_basis();
  std::vector<int> vertices = basis.LaneVertices();
  std::vector<float> lanes(static_cast<size_t>(basis.num_blocks()) * kSkinningLanes, 1.f);
  for (size_t lane = 0; lane < lanes.size(); ++lane) {
    const int v = vertices.empty() ? static_cast<int>(lane) : vertices[lane];
    if (v < 0 || v >= model.num_vertices()) continue;
    lanes[lane] = static_cast<float>(StrengthOf(model, strengths, v));
  }
  return lanes;
}

}  // namespace pleat
