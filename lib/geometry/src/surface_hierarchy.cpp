// Wavelets on a grid split samples into even and odd ones, predict the odd from the even, and let
// the even keep the mean of both. Lifting does the same where there is no grid. One level of it:
//
// 1. ChooseRemoved picks the "odd" vertices: an independent set, so that all neighbors of a removed
//    vertex stay and a level can be undone in any order. Vertices with few neighbors come first,
//    since they leave the smallest holes; more than twelve neighbors are never predicted from.
// 2. Predict gives each removed vertex weights on its neighbors. The coefficient is what the
//    prediction misses.
// 3. SpreadArea: the area that a removed vertex stood for goes to its neighbors in the same shares.
//    Areas start as 1 per vertex and tell how much of the surface a coarse vertex speaks for.
// 4. Update adds a share of the coefficient back to the neighbors such that the area-weighted mean
//    of the function stays. Without it the coarse level would be a subsampling, with all its
//    aliasing, and an error in a coarse coefficient would spread far.
// 5. Collapse joins each removed vertex to its nearest neighbor, which inherits its edges, so that
//    the surface stays connected and the next level has a graph to work on.
//
// Levels repeat until 24 vertices are left or none can be removed. Level sizes fall geometrically,
// so building costs about O(V log V) and a transform O(V) per function.
//
// All steps of a level run over all its vertices before the next step begins, and `update_` is
// filled in the order of `predict_`, so one index e addresses neighbor, predictor and update of an
// entry.
//
// A decoder builds the hierarchy from decoded connectivity and rest positions and must get the
// encoder's, bit for bit. Hence: sorts are stable, sums are written out instead of left to a
// vectorizing library, only + - * / and square roots are used (which IEEE 754 rounds exactly; the
// build forbids contraction), and ties go to the vertex that comes first. Even 8th roots are made
// of square roots.

#include "pleat/geometry/surface_hierarchy.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "pleat/mesh/adjacency.h"

namespace pleat {
namespace {

constexpr int kMaxNeighbors = 12;  // a vertex with more is not removed
constexpr int kNumCoarsest = 24;
// The pull towards equal weights, as a share of the squared distance. Without it nearly singular
// neighborhoods get weights that amplify the quantization error (.02 doubles the error of samba; 3
// costs 5 to 16 %).
constexpr double kRegularization = 0.3;

using Small = std::array<double, kMaxNeighbors>;

// Returns weights of sum 1 that reproduce `offsets` = 0 as well as possible: they minimize |D w|^2
// + r sum_i |d_i|^2 w_i^2 (locally linear embedding, Roweis and Saul 2000), by a Cholesky
// factorization that is written out for the sake of its order. Only the lower triangle of `gram` is
// used.
Small LinearWeights(const std::array<Eigen::Vector3d, kMaxNeighbors>& offsets, int n) {
  std::array<Small, kMaxNeighbors> gram;
  double trace = 0;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j <= i; ++j) {
      gram[i][j] = offsets[i].x() * offsets[j].x() + offsets[i].y() * offsets[j].y() +
                   offsets[i].z() * offsets[j].z();
    }
    trace += gram[i][i];
  }
  for (int i = 0; i < n; ++i) gram[i][i] += kRegularization * gram[i][i] + 1e-6 * trace + 1e-18;
  for (int j = 0; j < n; ++j) {
    for (int k = 0; k < j; ++k) gram[j][j] -= gram[j][k] * gram[j][k];
    gram[j][j] = std::sqrt(std::max(gram[j][j], 1e-30));
    for (int i = j + 1; i < n; ++i) {
      for (int k = 0; k < j; ++k) gram[i][j] -= gram[i][k] * gram[j][k];
      gram[i][j] /= gram[j][j];
    }
  }
  Small y;
  for (int i = 0; i < n; ++i) {
    y[i] = 1;
    for (int k = 0; k < i; ++k) y[i] -= gram[i][k] * y[k];
    y[i] /= gram[i][i];
  }
  double sum = 0;
  for (int i = n - 1; i >= 0; --i) {
    for (int k = i + 1; k < n; ++k) y[i] -= gram[k][i] * y[k];
    y[i] /= gram[i][i];
    sum += y[i];
  }
  for (int i = 0; i < n; ++i) y[i] /= sum;  // the matrix is positive definite, so the sum is too
  return y;
}

void AddScaled(float scale, const float* source, float* target, Eigen::Index count) {
  for (Eigen::Index i = 0; i < count; ++i) target[i] += scale * source[i];
}

}  // namespace

class SurfaceHierarchy::Builder {
 public:
  Builder(const Topology& topology, const Eigen::Matrix3Xf* rest, SurfaceHierarchy* result)
      : rest_(rest), result_(*result), num_vertices_(topology.num_vertices()) {
    const VertexAdjacency adjacency(topology);
    adjacency_.resize(num_vertices_);
    for (int v = 0; v < num_vertices_; ++v) {
      const auto neighbors = adjacency.neighbors(v);
      adjacency_[v].assign(neighbors.begin(), neighbors.end());
    }
    area_.assign(num_vertices_, 1);
    active_.resize(num_vertices_);
    std::iota(active_.begin(), active_.end(), 0);
    result_.starts_.assign(num_vertices_, 0);
    result_.counts_.assign(num_vertices_, 0);
  }

  void Build() {
    while (static_cast<int>(active_.size()) > kNumCoarsest) {
      std::vector<int32_t> removed = ChooseRemoved();
      if (removed.empty()) break;
      for (const int v : removed) Predict(v);
      for (const int v : removed) SpreadArea(v);
      for (const int v : removed) Update(v);
      for (const int v : removed) Collapse(v);
      std::erase_if(active_, [&](int v) { return result_.counts_[v] > 0; });
      result_.removed_.push_back(std::move(removed));
    }
    Finish();
  }

 private:
  double SquaredDistance(int a, int b) const {
    const Eigen::Vector3d d = rest_->col(a).cast<double>() - rest_->col(b).cast<double>();
    return d.x() * d.x() + d.y() * d.y() + d.z() * d.z();
  }

  // Chooses a set without neighbors in it, vertices with few edges first.
  std::vector<int32_t> ChooseRemoved() const {
    std::vector<int32_t> candidates = active_;
    std::stable_sort(candidates.begin(), candidates.end(),
                     [&](int a, int b) { return adjacency_[a].size() < adjacency_[b].size(); });
    const size_t most = active_.size() - kNumCoarsest;
    std::vector<bool> kept(num_vertices_, false);
    std::vector<int32_t> removed;
    for (const int v : candidates) {
      if (removed.size() >= most) break;
      if (kept[v] || adjacency_[v].empty() || adjacency_[v].size() > kMaxNeighbors) continue;
      removed.push_back(v);
      for (const int n : adjacency_[v]) kept[n] = true;
    }
    return removed;
  }

  void Predict(int v) {
    const std::vector<int32_t>& neighbors = adjacency_[v];
    const int n = static_cast<int>(neighbors.size());
    Small weights;
    weights.fill(1.0 / n);
    if (rest_ != nullptr && n > 1) {
      std::array<Eigen::Vector3d, kMaxNeighbors> offsets;
      for (int i = 0; i < n; ++i) {
        offsets[i] = rest_->col(neighbors[i]).cast<double>() - rest_->col(v).cast<double>();
      }
      weights = LinearWeights(offsets, n);
    }
    result_.starts_[v] = static_cast<int32_t>(result_.neighbors_.size());
    result_.counts_[v] = n;
    for (int i = 0; i < n; ++i) {
      result_.neighbors_.push_back(neighbors[i]);
      result_.predict_.push_back(static_cast<float>(weights[i]));
    }
  }

  // What the removed vertex stood for falls to its neighbors. Shares may be negative where a vertex
  // lies outside of its neighbors, so an area can shrink.
  void SpreadArea(int v) {
    for (int i = 0; i < result_.counts_[v]; ++i) {
      const int entry = result_.starts_[v] + i;
      area_[result_.neighbors_[entry]] += static_cast<double>(result_.predict_[entry]) * area_[v];
    }
  }

  // The update of smallest norm that keeps the mean of the function. It needs the areas of all
  // removed vertices of the level to be spread already.
  void Update(int v) {
    double sum = 1e-30;
    for (const int n : result_.neighbors(v)) sum += area_[n] * area_[n];
    for (const int n : result_.neighbors(v)) {
      result_.update_.push_back(static_cast<float>(area_[v] * area_[n] / sum));
    }
  }

  // Joins v to its nearest neighbor (half-edge collapse), so that the surface stays connected.
  // Lists stay symmetric and without repetition.
  void Collapse(int v) {
    int nearest = -1;
    double least = 0;
    for (const int n : adjacency_[v]) {
      const double cost =
          rest_ != nullptr ? SquaredDistance(n, v) : static_cast<double>(adjacency_[n].size());
      if (nearest < 0 || cost < least) {
        nearest = n;
        least = cost;
      }
    }
    for (const int n : adjacency_[v]) {
      std::vector<int32_t>& around = adjacency_[n];
      around.erase(std::find(around.begin(), around.end(), v));
      if (n == nearest || std::find(around.begin(), around.end(), nearest) != around.end())
        continue;
      around.push_back(nearest);
      adjacency_[nearest].push_back(n);
    }
    adjacency_[v].clear();
  }

  void Finish() {
    result_.order_ = active_;
    result_.levels_.assign(num_vertices_, static_cast<int32_t>(result_.removed_.size()));
    for (size_t level = result_.removed_.size(); level-- > 0;) {
      for (const int v : result_.removed_[level]) {
        result_.order_.push_back(v);
        result_.levels_[v] = static_cast<int32_t>(level);
      }
    }
    for (const double area : area_) {  // area^(3/8): between 1/2, of exact norms, and 0
      const double fourth_root = std::sqrt(std::sqrt(std::max(area, 0.1)));
      result_.weights_of_error_.push_back(static_cast<float>(fourth_root * std::sqrt(fourth_root)));
    }
  }

  const Eigen::Matrix3Xf* rest_;
  SurfaceHierarchy& result_;
  const int num_vertices_;
  std::vector<std::vector<int32_t>> adjacency_;
  std::vector<double> area_;
  std::vector<int32_t> active_;
};

SurfaceHierarchy::SurfaceHierarchy(const Topology& topology, const Eigen::Matrix3Xf* rest) {
  Builder(topology, rest, this).Build();
}

void SurfaceHierarchy::Analyze(FieldMatrix* fields) const {
  const Eigen::Index count = fields->cols();
  for (const std::vector<int32_t>& level : removed_) {
    for (const int v : level) {
      for (int e = starts_[v]; e < starts_[v] + counts_[v]; ++e) {
        AddScaled(-predict_[e], &fields->coeffRef(neighbors_[e], 0), &fields->coeffRef(v, 0),
                  count);
      }
    }
    for (const int v : level) {
      for (int e = starts_[v]; e < starts_[v] + counts_[v]; ++e) {
        AddScaled(update_[e], &fields->coeffRef(v, 0), &fields->coeffRef(neighbors_[e], 0), count);
      }
    }
  }
}

void SurfaceHierarchy::Synthesize(FieldMatrix* fields) const {
  const Eigen::Index count = fields->cols();
  for (size_t level = removed_.size(); level-- > 0;) {
    for (const int v : removed_[level]) {
      for (int e = starts_[v]; e < starts_[v] + counts_[v]; ++e) {
        AddScaled(-update_[e], &fields->coeffRef(v, 0), &fields->coeffRef(neighbors_[e], 0), count);
      }
    }
    for (const int v : removed_[level]) {
      for (int e = starts_[v]; e < starts_[v] + counts_[v]; ++e) {
        AddScaled(predict_[e], &fields->coeffRef(neighbors_[e], 0), &fields->coeffRef(v, 0), count);
      }
    }
  }
}

}  // namespace pleat
