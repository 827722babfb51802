// Predicts how a frame moved since the last one, in integers of the session's grid.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/mesh/topology.h"
#include "pleat/stream/stream_header.h"

namespace pleat {

// Positions on the grid of a box: x = origin + k step.
void SnapToGrid(const Eigen::Ref<const Eigen::Matrix3Xf>& positions, const QuantizationBox& box,
                Eigen::Matrix3Xi* integers);
void PlaceOnGrid(const Eigen::Matrix3Xi& integers, const QuantizationBox& box,
                 Eigen::Matrix3Xf* positions);

// FNV-1a over the integers as 32-bit words, x, y, z of vertex 0, of vertex 1, ...
uint32_t GridChecksum(const Eigen::Matrix3Xi& integers);

// The movement of a vertex is predicted from its neighbors' on a coarser mesh, coarse vertices
// first: unlike a parallelogram this interpolates. Integers only, from what the header says, so
// that client and server agree.
class DeltaPredictor {
 public:
  // topology, reference: as a decoder sees them (FrameDecoder), meters.
  DeltaPredictor(const Topology& topology, const Eigen::Matrix3Xf& reference,
                 const QuantizationBox& box);

  // residuals (3 x V): column i belongs to the i-th vertex of the walk. movement: scratch, as all
  // matrices allocated only when V changes.
  void Residuals(const Eigen::Matrix3Xi& last, const Eigen::Matrix3Xi& now,
                 Eigen::Matrix3Xi* movement, Eigen::Matrix3Xi* residuals) const;
  // The inverse; false when a coordinate leaves what is allowed (damaged residuals).
  bool Restore(const Eigen::Matrix3Xi& last, const Eigen::Matrix3Xi& residuals,
               Eigen::Matrix3Xi* now) const;

 private:
  template <typename Visit>
  bool Walk(Eigen::Matrix3Xi* movement, Visit visit) const;

  std::vector<int32_t> order_;      // coarse to fine
  std::vector<int32_t> starts_;     // V + 1, into the next two
  std::vector<int32_t> neighbors_;  // of order_[i]
  std::vector<int32_t> weights_;    // sum kWeightSum per vertex
};

}  // namespace pleat
