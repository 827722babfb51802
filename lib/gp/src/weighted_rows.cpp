// The same code is compiled for three instruction sets: it is inlined into each function.
#include "weighted_rows.h"

#include <algorithm>
#include <vector>

namespace pleat {
namespace {

inline __attribute__((always_inline)) void Add(const float* factors, const float* rows,
                                               ptrdiff_t num_rows, ptrdiff_t num_cols,
                                               float* sums) {
  typedef float Lanes __attribute__((vector_size(64), aligned(4), may_alias));
  constexpr ptrdiff_t kLanes = 16, kRegisters = 8;
  ptrdiff_t begin = 0;
  for (; begin + kLanes * kRegisters <= num_cols; begin += kLanes * kRegisters) {
    Lanes block[kRegisters];
    for (ptrdiff_t i = 0; i < kRegisters; ++i) {
      block[i] = *reinterpret_cast<const Lanes*>(sums + begin + i * kLanes);
    }
    for (ptrdiff_t n = 0; n < num_rows; ++n) {
      const auto* row = reinterpret_cast<const Lanes*>(rows + n * num_cols + begin);
      for (ptrdiff_t i = 0; i < kRegisters; ++i) block[i] += factors[n] * row[i];
    }
    for (ptrdiff_t i = 0; i < kRegisters; ++i) {
      *reinterpret_cast<Lanes*>(sums + begin + i * kLanes) = block[i];
    }
  }
  for (ptrdiff_t n = 0; n < num_rows; ++n) {
    for (ptrdiff_t c = begin; c < num_cols; ++c) sums[c] += factors[n] * rows[n * num_cols + c];
  }
}

void AddForAny(const float* factors, const float* rows, ptrdiff_t num_rows, ptrdiff_t num_cols,
               float* sums) {
  Add(factors, rows, num_rows, num_cols, sums);
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) void AddForAvx2(const float* factors, const float* rows,
                                                ptrdiff_t num_rows, ptrdiff_t num_cols,
                                                float* sums) {
  Add(factors, rows, num_rows, num_cols, sums);
}
__attribute__((target("avx512f,prefer-vector-width=512"))) void AddForAvx512(
    const float* factors, const float* rows, ptrdiff_t num_rows, ptrdiff_t num_cols, float* sums) {
  Add(factors, rows, num_rows, num_cols, sums);
}
#endif

std::vector<AddWeightedRowsFunction> FindUsable() {
  std::vector<AddWeightedRowsFunction> usable;
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f")) usable.push_back(AddForAvx512);
  if (__builtin_cpu_supports("avx2")) usable.push_back(AddForAvx2);
#endif
  usable.push_back(AddForAny);
  return usable;
}

}  // namespace

std::span<const AddWeightedRowsFunction> UsableAddWeightedRows() {
  static const std::vector<AddWeightedRowsFunction> usable = FindUsable();
  return usable;
}

}  // namespace pleat
