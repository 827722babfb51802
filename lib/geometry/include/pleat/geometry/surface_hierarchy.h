// A multiresolution transform of functions on a mesh: second-generation wavelets by lifting
// (Sweldens 1998; on irregular points Jansen, Nason and Silverman 2009). Vertices are removed level
// by level as independent sets; each is predicted from its neighbors, which keep its mean
// (docs/method/codec.md#surface-hierarchy). Plain arithmetic in a fixed order: encoder and decoder
// get the same bits on every machine. So any change of an operation or of its order is a change of
// the file format.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "pleat/mesh/topology.h"

namespace pleat {

// A matrix with one row per vertex and one column per function. Rows are contiguous, since a
// lifting step adds whole rows.
using FieldMatrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Immutable after construction; one hierarchy serves any number of threads.
class SurfaceHierarchy {
 public:
  // Builds the hierarchy. rest: 3 x V, makes the prediction exact for functions that are linear in
  // the rest positions, as far as that does not amplify noise; null predicts the mean of the
  // neighbors.
  SurfaceHierarchy(const Topology& topology, const Eigen::Matrix3Xf* rest);

  // The vertices from coarse to fine: an order in which neighbors(v) come before v.
  const std::vector<int32_t>& order() const { return order_; }
  // Returns the coarser vertices that predict v; none for the coarsest vertices.
  std::span<const int32_t> neighbors(int v) const {
    return std::span(neighbors_).subspan(starts_[v], counts_[v]);
  }
  int level(int v) const { return levels_[v]; }  // 0 = finest; the coarsest have the largest
  // Returns how much an error of coefficient v weighs in the function.
  float weight(int v) const { return weights_of_error_[v]; }

  // Turn values into coefficients and back, in place, for all columns (V x N). Each is the inverse
  // of the other up to the rounding of float sums.
  void Analyze(FieldMatrix* fields) const;
  void Synthesize(FieldMatrix* fields) const;

 private:
  class Builder;

  std::vector<int32_t> order_, neighbors_;
  std::vector<int32_t> starts_, counts_, levels_;  // per vertex
  std::vector<float> predict_, update_;            // per entry of neighbors_
  std::vector<float> weights_of_error_;
  std::vector<std::vector<int32_t>> removed_;  // per level, fine to coarse
};

}  // namespace pleat
