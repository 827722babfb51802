#include "glb_remainders.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace pleat {
namespace {

using nlohmann::json;

std::optional<GlbAccessor> ScalarsOf(const GlbContainer& glb, const json& lists, const char* name) {
  const absl::StatusOr<GlbAccessor> accessor = glb.Access(lists.value(name, json()), "SCALAR");
  if (!accessor.ok()) return std::nullopt;
  return *accessor;
}

}  // namespace

std::optional<GlbRemainders> ReadGlbRemainders(const GlbContainer& glb, const GlbPart& part) {
  const json& node = glb.List("nodes")[static_cast<size_t>(part.node)];
  const json& mesh = glb.Entry("meshes", node.value("mesh", json()));
  const json extras = mesh.is_object() ? mesh.value("extras", json()) : json();
  const json lists = extras.is_object() ? extras.value("pleat_remainders", json()) : json();
  if (!lists.is_object() || part.skin >= 0) return std::nullopt;
  const std::optional<GlbAccessor> counts = ScalarsOf(glb, lists, "counts"),
                                   indices = ScalarsOf(glb, lists, "indices"),
                                   values = ScalarsOf(glb, lists, "values");
  if (!counts || !indices || !values || counts->count() != part.targets.size() ||
      indices->count() != values->count()) {
    return std::nullopt;
  }
  GlbRemainders remainders{.begins = {0}, .indices = {}, .values = values->CopyFloats()};
  for (size_t i = 0; i < counts->count(); ++i) {
    const double count = counts->At(i, 0);
    const size_t room = values->count() - remainders.begins.back();
    if (!(count >= 0 && count <= static_cast<double>(room))) return std::nullopt;
    remainders.begins.push_back(remainders.begins.back() + static_cast<size_t>(count));
  }
  for (size_t i = 0; i < indices->count(); ++i) {
    const double index = indices->At(i, 0);
    if (!(index >= 0 && index < static_cast<double>(part.positions.size()))) return std::nullopt;
    remainders.indices.push_back(static_cast<int64_t>(index));
  }
  return remainders;
}

void ApplyGlbRemainders(const GlbRemainders& remainders, const std::vector<float>& weights,
                        const Eigen::Matrix3Xd& base, Eigen::Matrix3Xf* frame) {
  constexpr double kRounding = 2.5e-7;  // two roundings to float32, of the sum and of the delta
  const auto one = std::ranges::find(weights, 1.f);
  const auto target = static_cast<size_t>(one - weights.begin());
  if (one == weights.end() || weights.size() + 1 != remainders.begins.size() ||
      std::ranges::count(weights, 0.f) + 1 != static_cast<std::ptrdiff_t>(weights.size())) {
    return;
  }
  for (size_t i = remainders.begins[target]; i < remainders.begins[target + 1]; ++i) {
    float& position = frame->data()[remainders.indices[i]];
    const float value = remainders.values[i];
    const double size = std::abs(double{position}) + std::abs(base.data()[remainders.indices[i]]);
    if (std::abs(double{value} - position) <= kRounding * size) position = value;
  }
}

}  // namespace pleat
