#include "pleat/skinning/skin_weights.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "absl/strings/str_cat.h"

namespace pleat {

absl::StatusOr<SkinWeights> SkinWeights::FromDense(const Eigen::Ref<const Eigen::MatrixXd>& dense) {
  SkinWeights result;
  result.num_joints_ = static_cast<int>(dense.cols());
  result.influences_.resize(dense.rows());
  std::vector<int> order(std::max<Eigen::Index>(0, dense.cols() - 1));
  const size_t kept = std::min<size_t>(kStandardInfluences, order.size());
  for (Eigen::Index v = 0; v < dense.rows(); ++v) {
    std::iota(order.begin(), order.end(), 1);
    // Ties go to the lower bone, so that equal weights give the same influences everywhere.
    std::stable_sort(order.begin(), order.end(),
                     [&](int a, int b) { return dense(v, a) > dense(v, b); });
    double total = 0;
    for (size_t k = 0; k < kept; ++k) total += std::max(0.0, dense(v, order[k]));
    // A NaN compares with nothing, so it may stand anywhere in the order.
    const bool is_number = std::none_of(order.begin(), order.end(),
                                        [&](int bone) { return std::isnan(dense(v, bone)); });
    if (!is_number || !(total > 0) || !std::isfinite(total)) {
      return absl::InvalidArgumentError(
          absl::StrCat("vertex ", v, " has no positive, finite skinning weight"));
    }
    for (size_t k = 0; k < kept; ++k) {
      const double weight = std::max(0.0, dense(v, order[k])) / total;
      if (weight <= 0) break;
      result.influences_[v].bones[k] = static_cast<uint16_t>(order[k]);
      result.influences_[v].weights[k] = static_cast<float>(weight);
    }
  }
  return result;
}

absl::StatusOr<SkinWeights> SkinWeights::Create(int num_joints,
                                                std::vector<VertexInfluences> influences) {
  for (size_t v = 0; v < influences.size(); ++v) {
    float total = 0;
    for (int k = 0; k < kMaxInfluences; ++k) {
      const float weight = influences[v].weights[k];
      const int bone = influences[v].bones[k];
      const bool after_unused = k > 0 && weight > 0 && influences[v].weights[k - 1] == 0;
      if (!std::isfinite(weight) || weight < 0 || after_unused ||
          (weight > 0 && (bone < 1 || bone >= num_joints))) {
        return absl::InvalidArgumentError(absl::StrCat("vertex ", v, ": influence ", k, " (bone ",
                                                       bone, ", weight ", weight, ") is invalid"));
      }
      total += weight;
      // Kernels read the bones of all entries, whatever their weight.
      if (weight == 0) influences[v].bones[k] = 0;
    }
    if (std::abs(total - 1) > 1e-4f) {
      return absl::InvalidArgumentError(
          absl::StrCat("vertex ", v, ": the skinning weights add up to ", total, ", not 1"));
    }
  }
  SkinWeights result;
  result.num_joints_ = num_joints;
  result.influences_ = std::move(influences);
  return result;
}

VertexInfluences StrongestInfluences(const std::map<int, double>& bone_weights) {
  std::vector<std::pair<double, int>> sorted;
  for (const auto& [bone, weight] : bone_weights) sorted.push_back({-weight, bone});
  std::sort(sorted.begin(), sorted.end());
  if (sorted.size() > kMaxInfluences) sorted.resize(kMaxInfluences);
  double total = 0;
  for (const auto& [negative, bone] : sorted) total -= negative;
  VertexInfluences result;
  for (size_t k = 0; k < sorted.size(); ++k) {
    result.bones[k] = static_cast<uint16_t>(sorted[k].second);
    result.weights[k] = static_cast<float>(-sorted[k].first / total);
  }
  return result;
}

int SkinWeights::most_influences() const {
  size_t most = 0;
  for (const VertexInfluences& vertex : influences_) {
    while (most < kMaxInfluences && vertex.weights[most] > 0) ++most;
  }
  return static_cast<int>(most);
}

Eigen::MatrixXd SkinWeights::ToDense() const {
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(num_vertices(), num_joints_);
  for (int v = 0; v < num_vertices(); ++v) {
    for (int k = 0; k < kMaxInfluences; ++k) {
      if (influences_[v].weights[k] > 0) {
        dense(v, influences_[v].bones[k]) = influences_[v].weights[k];
      }
    }
  }
  return dense;
}

}  // namespace pleat
