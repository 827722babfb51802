// Predicts how the vertices have moved since the last frame, in integers on the session's grid
// (docs/method/streams.md#differences).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/mesh/topology.h"
#include "pleat/stream/stream_header.h"

namespace pleat {

// Convert between positions in meters (3 x V) and integers k on the grid of a box, where
// x = origin + k step. Positions must be less than 2^26 steps away from the origin.
void SnapToGrid(const Eigen::Ref<const Eigen::Matrix3Xf>& positions, const QuantizationBox& box,
                Eigen::Matrix3Xi* integers);
void PlaceOnGrid(const Eigen::Matrix3Xi& integers, const QuantizationBox& box,
                 Eigen::Matrix3Xf* positions);

// Returns FNV-1a over the integers as 32-bit words: x, y and z of vertex 0, then of vertex 1, etc.
uint32_t GridChecksum(const Eigen::Matrix3Xi& integers);

// The movement of a vertex is predicted from the movements of its neighbors on a coarser level,
// which come before it. Unlike the parallelogram rule of mesh coders, this interpolates. All of it
// is integer arithmetic on what the header says, so the encoder and every decoder make the same
// predictions. Immutable after construction; threads may share it.
class DeltaPredictor {
 public:
  // topology, reference: as a FrameDecoder gives them, because they must be the same on both sides.
  // The reference is 3 x V, meters.
  DeltaPredictor(const Topology& topology, const Eigen::Matrix3Xf& reference,
                 const QuantizationBox& box);

  // last, now: two frames, 3 x V, in grid steps. residuals: 3 x V, column i belongs to the i-th
  // vertex of the walk, not to vertex i. movement: scratch memory. Both outputs are allocated only
  // when V changes.
  void Residuals(const Eigen::Matrix3Xi& last, const Eigen::Matrix3Xi& now,
                 Eigen::Matrix3Xi* movement, Eigen::Matrix3Xi* residuals) const;
  // The inverse. Returns false when damaged residuals move a coordinate beyond 2^26 steps.
  bool Restore(const Eigen::Matrix3Xi& last, const Eigen::Matrix3Xi& residuals,
               Eigen::Matrix3Xi* now) const;

 private:
  template <typename Visit>
  bool Walk(Eigen::Matrix3Xi* movement, Visit visit) const;

  std::vector<int32_t> order_;  // V: the walk over the vertices, from coarse to fine
  // Entries starts_[i] to starts_[i + 1] of the two lists below belong to the vertex order_[i].
  std::vector<int32_t> starts_;  // V + 1
  std::vector<int32_t> neighbors_;
  std::vector<int32_t> weights_;  // add up to kWeightSum for each vertex that has neighbors
};

}  // namespace pleat
