// Encoder and decoder both walk over the vertices from coarse to fine, and each predicts a movement
// from the movements that it has already passed. The decoder can do this because neighbors always
// come earlier in the walk than the vertex that they predict. The two sides must agree on every
// bit, or the difference would restore another frame. Hence the weights and predictions are
// integers, the hierarchy is built from integers too, and any change of this file changes the
// stream format (docs/formats/frame_stream.md).
#include "delta_predictor.h"

#include "pleat/geometry/surface_hierarchy.h"

namespace pleat {
namespace {

constexpr int kWeightBits = 12, kWeightSum = 1 << kWeightBits;
// What a decoder accepts. An encoder stays below 2^25: it sends coordinates within 16 box edges of
// the box, and an edge has at most 2^20 steps.
constexpr int64_t kMaxCoordinate = int64_t{1} << 26;
constexpr int kShift = 1 << 27;  // larger than kMaxCoordinate, so that shifted numbers are positive

// Divides kWeightSum among the neighbors in inverse proportion to their squared distance. The last
// neighbor gets what rounding leaves, so the weights of a vertex add up exactly.
void AppendWeights(const Eigen::Matrix3Xi& grid, int v, std::span<const int32_t> neighbors,
                   std::vector<int32_t>* weights) {
  std::vector<int64_t> inverse;
  int64_t sum = 0;
  for (const int n : neighbors) {
    int64_t square = 1;
    for (int c = 0; c < 3; ++c) {
      const int64_t d = int64_t{grid(c, n)} - grid(c, v);
      square += d * d;
    }
    inverse.push_back((int64_t{1} << 40) / square + 1);
    sum += inverse.back();
  }
  int left = kWeightSum;
  for (size_t i = 0; i < inverse.size(); ++i) {
    const bool last = i + 1 == inverse.size();
    const int weight = last ? left : static_cast<int>((inverse[i] << kWeightBits) / sum);
    weights->push_back(weight);
    left -= weight;
  }
}

}  // namespace

void SnapToGrid(const Eigen::Ref<const Eigen::Matrix3Xf>& positions, const QuantizationBox& box,
                Eigen::Matrix3Xi* integers) {
  integers->resize(3, positions.cols());
  const double scale = 1 / box.step_m();
  for (Eigen::Index v = 0; v < positions.cols(); ++v) {
    for (int c = 0; c < 3; ++c) {
      const double x = static_cast<double>(positions(c, v)) - box.origin_m[c];
      // This is floor(x * scale + 1/2) without a library call: a cast rounds positive numbers down.
      (*integers)(c, v) = static_cast<int>(x * scale + (kShift + 0.5)) - kShift;
    }
  }
}

void PlaceOnGrid(const Eigen::Matrix3Xi& integers, const QuantizationBox& box,
                 Eigen::Matrix3Xf* positions) {
  positions->resize(3, integers.cols());
  const double step_m = box.step_m();
  for (Eigen::Index v = 0; v < integers.cols(); ++v) {
    for (int c = 0; c < 3; ++c) {
      (*positions)(c, v) = static_cast<float>(box.origin_m[c] + integers(c, v) * step_m);
    }
  }
}

uint32_t GridChecksum(const Eigen::Matrix3Xi& integers) {
  uint32_t hash = 0x811c9dc5u;
  for (const int k : integers.reshaped()) hash = (hash ^ static_cast<uint32_t>(k)) * 0x01000193u;
  return hash;
}

DeltaPredictor::DeltaPredictor(const Topology& topology, const Eigen::Matrix3Xf& reference,
                               const QuantizationBox& box) {
  Eigen::Matrix3Xi grid;
  SnapToGrid(reference, box, &grid);
  // Whole numbers below 2^24 are exact in float32, and their squared distances are exact in
  // float64, so the hierarchy does not depend on how a machine rounds. The reference lies inside
  // the box and has at most 2^20 steps.
  const Eigen::Matrix3Xf whole = grid.cast<float>();
  const SurfaceHierarchy hierarchy(topology, &whole);
  order_ = hierarchy.order();
  starts_.push_back(0);
  for (const int v : order_) {
    const auto neighbors = hierarchy.neighbors(v);
    neighbors_.insert(neighbors_.end(), neighbors.begin(), neighbors.end());
    AppendWeights(grid, v, neighbors, &weights_);
    starts_.push_back(static_cast<int32_t>(neighbors_.size()));
  }
}

// Calls visit(i, v, predicted) for every vertex v = order_[i] until a call returns false. When
// visit returns, column v of `movement` must hold the true movement, since later predictions read
// it.
template <typename Visit>
bool DeltaPredictor::Walk(Eigen::Matrix3Xi* movement, Visit visit) const {
  int64_t predicted[3] = {0, 0, 0};
  const int count = static_cast<int>(order_.size());
  for (int i = 0; i < count; ++i) {
    int64_t sum[3] = {kWeightSum / 2, kWeightSum / 2, kWeightSum / 2};
    for (int e = starts_[i]; e < starts_[i + 1]; ++e) {
      const int* near = movement->data() + 3 * static_cast<size_t>(neighbors_[e]);
      for (int c = 0; c < 3; ++c) sum[c] += int64_t{weights_[e]} * near[c];
    }
    if (starts_[i + 1] > starts_[i]) {
      for (int c = 0; c < 3; ++c) predicted[c] = sum[c] >> kWeightBits;
    } else if (i > 0) {  // without neighbors, a vertex is expected to move like the one before it
      for (int c = 0; c < 3; ++c) predicted[c] = (*movement)(c, order_[i - 1]);
    }
    if (!visit(i, order_[i], predicted)) return false;
  }
  return true;
}

void DeltaPredictor::Residuals(const Eigen::Matrix3Xi& last, const Eigen::Matrix3Xi& now,
                               Eigen::Matrix3Xi* movement, Eigen::Matrix3Xi* residuals) const {
  *movement = now - last;
  residuals->resize(3, now.cols());
  Walk(movement, [&](int i, int v, const int64_t* predicted) {
    for (int c = 0; c < 3; ++c) {
      (*residuals)(c, i) = static_cast<int>((*movement)(c, v) - predicted[c]);
    }
    return true;
  });
}

bool DeltaPredictor::Restore(const Eigen::Matrix3Xi& last, const Eigen::Matrix3Xi& residuals,
                             Eigen::Matrix3Xi* now) const {
  Eigen::Matrix3Xi movement(3, last.cols());
  now->resize(3, last.cols());
  return Walk(&movement, [&](int i, int v, const int64_t* predicted) {
    for (int c = 0; c < 3; ++c) {
      const int64_t moved = predicted[c] + residuals(c, i);
      const int64_t coordinate = last(c, v) + moved;
      if (coordinate > kMaxCoordinate || coordinate < -kMaxCoordinate) return false;
      movement(c, v) = static_cast<int>(moved);
      (*now)(c, v) = static_cast<int>(coordinate);
    }
    return true;
  });
}

}  // namespace pleat
