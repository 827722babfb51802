// Row vectors times a matrix, on the widest registers of this processor.
#pragma once

#include <cstddef>
#include <span>

#include "pleat/simd/dispatch.h"

namespace pleat {

inline constexpr int kMaxWeightedTogether = 4;  // vectors that are multiplied in one pass

// sums[q][c] += sum_n factors[q][n] rows[n * num_cols + c]. Every sum runs over n from the first
// row to the last: all kernels give the same bits, for any number of vectors. Scalar: float or
// double.
template <typename Scalar>
struct WeightedRowsKernel {
  // [k]: for k + 1 vectors.
  using Function = void (*)(const Scalar* const* factors, const Scalar* rows, ptrdiff_t num_rows,
                            ptrdiff_t num_cols, Scalar* const* sums);
  Function add[kMaxWeightedTogether];
};

// Those this processor can run, the fastest first.
template <typename Scalar>
const KernelVariants<WeightedRowsKernel<Scalar>>& WeightedRowsVariants();

// For any number of vectors.
void AddWeightedRows(std::span<const float* const> factors, const float* rows, ptrdiff_t num_rows,
                     ptrdiff_t num_cols, std::span<float* const> sums);
void AddWeightedRows(std::span<const double* const> factors, const double* rows, ptrdiff_t num_rows,
                     ptrdiff_t num_cols, std::span<double* const> sums);

// For one.
inline void AddWeightedRows(const double* factors, const double* rows, ptrdiff_t num_rows,
                            ptrdiff_t num_cols, double* sums) {
  AddWeightedRows(std::span(&factors, 1), rows, num_rows, num_cols, std::span(&sums, 1));
}

}  // namespace pleat
