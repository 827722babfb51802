// Row vectors times a matrix in single precision, on the widest registers of this processor.
#pragma once

#include <cstddef>
#include <span>

namespace pleat {

inline constexpr int kMaxWeightedTogether = 4;  // vectors that are multiplied in one pass

// sums[q][c] += sum_n factors[q][n] rows[n * num_cols + c]. Every sum runs over n from the first
// row to the last: all kernels give the same bits, for any number of vectors.
struct WeightedRowsKernel {
  // [k]: for k + 1 vectors.
  using Function = void (*)(const float* const* factors, const float* rows, ptrdiff_t num_rows,
                            ptrdiff_t num_cols, float* const* sums);
  Function add[kMaxWeightedTogether];
};

// Those this processor can run, the fastest first.
std::span<const WeightedRowsKernel* const> UsableWeightedRows();

// For any number of vectors.
void AddWeightedRows(std::span<const float* const> factors, const float* rows, ptrdiff_t num_rows,
                     ptrdiff_t num_cols, std::span<float* const> sums);

}  // namespace pleat
