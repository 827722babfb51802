// A row vector times a matrix in single precision, on the widest registers of this processor.
#pragma once

#include <cstddef>
#include <span>

namespace pleat {

// sums[c] += sum_n factors[n] rows[n * num_cols + c]. Every sum runs over n from the first row to
// the last: all kernels give the same bits.
using AddWeightedRowsFunction = void (*)(const float* factors, const float* rows,
                                         ptrdiff_t num_rows, ptrdiff_t num_cols, float* sums);

// Those this processor can run, the fastest first.
std::span<const AddWeightedRowsFunction> UsableAddWeightedRows();

inline void AddWeightedRows(const float* factors, const float* rows, ptrdiff_t num_rows,
                            ptrdiff_t num_cols, float* sums) {
  UsableAddWeightedRows().front()(factors, rows, num_rows, num_cols, sums);
}

}  // namespace pleat
