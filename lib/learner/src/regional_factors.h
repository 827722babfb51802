// The kernel values of a regional GP between one row and all rows of the training.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "pleat/base/large_page_allocator.h"
#include "pleat/learner/regional_gp.h"
#include "pleat/simd/dispatch.h"

namespace pleat {

// The kernels of all regions in the order in which a query computes them. Columns that belong to
// the same sets are one atom: distances are summed over them only once, and the sum over a set that
// several scales share is formed only once.
//
// A row of a set that is longer than the bound of the set is shortened to it, by s = bound / |x|.
// Its columns are shared with other sets, so not the row is changed but the sums over it:
//
//   s x . x_n = s (x . x_n),   |s x - x_n|^2 = s^2 |x|^2 + |x_n|^2 - 2 s (x . x_n)
//
// The rows are stored in single precision; sums over them are double, because a distance is what
// is left of numbers that nearly cancel. From the distances on all is single: the weights of the
// regions magnify an error of the kernels by several hundred, but these are as exact as a float.
class RegionalFactors {
 public:
  RegionalFactors() = default;
  explicit RegionalFactors(const RegionalGpParameters& parameters);  // alphas are not needed

  size_t memory_bytes() const { return inputs_.size() * sizeof(float); }
  // Doubles that Compute() needs for its own use.
  size_t scratch_size() const;

  // The rows of the training, N x num_inputs; zeros in columns that no set has.
  Eigen::MatrixXd Inputs(Eigen::Index num_inputs) const;

  // row: D, normalized. factors[r * N + n] = k_r(row, row n of the training).
  void Compute(const double* row, double* scratch, float* factors) const;

  // Kernels this processor can run, the fastest first; all give the same bits.
  using Function = void (*)(const RegionalFactors& factors_of, const double* row, double* scratch,
                            float* factors);
  static const KernelVariants<Function>& Variants();

  static constexpr ptrdiff_t kLanes = 16;  // rows of the training that are computed together
  struct Scale {
    ptrdiff_t set = 0;
    float exponent = 0;  // -g / 2
    float amplitude = 1, linear = 0;
  };
  struct Region {
    float bias = 0;
    size_t end_scale = 0;  // of its scales in `scales_`
  };

 private:
  friend struct RegionalFactorsKernel;

  void StoreRows(const Eigen::MatrixXd& inputs);
  size_t chunk_size() const { return kLanes * (columns_.size() + 2 * atom_ends_.size()); }

  ptrdiff_t num_rows_ = 0;
  // By kLanes rows, in these by columns in the order of the atoms, then the squared norm of the row
  // in each atom, as a float and what that rounds off; zeros after the last row.
  std::vector<float, LargePageAllocator<float>> inputs_;
  std::vector<int> columns_;        // of all atoms, one after the other
  std::vector<size_t> atom_ends_;   // in columns_
  std::vector<int> set_atoms_;      // of all sets, one after the other
  std::vector<size_t> set_ends_;    // in set_atoms_
  std::vector<double> set_bounds_;  // the longest row of each set
  std::vector<Scale> scales_;       // of all regions, one after the other
  std::vector<Region> regions_;
};

}  // namespace pleat
