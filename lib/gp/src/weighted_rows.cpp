// The same code is compiled for three instruction sets: it is inlined into each function.
#include "weighted_rows.h"

#include <algorithm>
#include <vector>

namespace pleat {
namespace {

typedef float Lanes __attribute__((vector_size(64), aligned(4), may_alias));

template <int kVectors>
inline __attribute__((always_inline)) void Add(const float* const* factors, const float* rows,
                                               ptrdiff_t num_rows, ptrdiff_t num_cols,
                                               float* const* sums) {
  constexpr ptrdiff_t kLanes = 16, kRegisters = kVectors == 1 ? 8 : 4;
  ptrdiff_t begin = 0;
  for (; begin + kLanes * kRegisters <= num_cols; begin += kLanes * kRegisters) {
    Lanes block[kVectors][kRegisters];
#pragma GCC unroll 4
    for (int q = 0; q < kVectors; ++q) {
#pragma GCC unroll 8
      for (ptrdiff_t i = 0; i < kRegisters; ++i) {
        block[q][i] = *reinterpret_cast<const Lanes*>(sums[q] + begin + i * kLanes);
      }
    }
    for (ptrdiff_t n = 0; n < num_rows; ++n) {
      const Lanes* row = reinterpret_cast<const Lanes*>(rows + n * num_cols + begin);
#pragma GCC unroll 8
      for (ptrdiff_t i = 0; i < kRegisters; ++i) {
#pragma GCC unroll 4
        for (int q = 0; q < kVectors; ++q) block[q][i] += factors[q][n] * row[i];
      }
    }
#pragma GCC unroll 4
    for (int q = 0; q < kVectors; ++q) {
#pragma GCC unroll 8
      for (ptrdiff_t i = 0; i < kRegisters; ++i) {
        *reinterpret_cast<Lanes*>(sums[q] + begin + i * kLanes) = block[q][i];
      }
    }
  }
  for (int q = 0; q < kVectors; ++q) {
    for (ptrdiff_t n = 0; n < num_rows; ++n) {
      for (ptrdiff_t c = begin; c < num_cols; ++c) {
        sums[q][c] += factors[q][n] * rows[n * num_cols + c];
      }
    }
  }
}

template <int kVectors>
void AddForAny(const float* const* factors, const float* rows, ptrdiff_t num_rows,
               ptrdiff_t num_cols, float* const* sums) {
  Add<kVectors>(factors, rows, num_rows, num_cols, sums);
}
constexpr WeightedRowsKernel kAny = {{AddForAny<1>, AddForAny<2>, AddForAny<3>, AddForAny<4>}};

#if defined(__x86_64__)
template <int kVectors>
__attribute__((target("avx2"))) void AddForAvx2(const float* const* factors, const float* rows,
                                                ptrdiff_t num_rows, ptrdiff_t num_cols,
                                                float* const* sums) {
  Add<kVectors>(factors, rows, num_rows, num_cols, sums);
}
constexpr WeightedRowsKernel kAvx2 = {{AddForAvx2<1>, AddForAvx2<2>, AddForAvx2<3>, AddForAvx2<4>}};

template <int kVectors>
__attribute__((target("avx512f,prefer-vector-width=512"))) void AddForAvx512(
    const float* const* factors, const float* rows, ptrdiff_t num_rows, ptrdiff_t num_cols,
    float* const* sums) {
  Add<kVectors>(factors, rows, num_rows, num_cols, sums);
}
constexpr WeightedRowsKernel kAvx512 = {
    {AddForAvx512<1>, AddForAvx512<2>, AddForAvx512<3>, AddForAvx512<4>}};
#endif

std::vector<const WeightedRowsKernel*> FindUsable() {
  std::vector<const WeightedRowsKernel*> usable;
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f")) usable.push_back(&kAvx512);
  if (__builtin_cpu_supports("avx2")) usable.push_back(&kAvx2);
#endif
  usable.push_back(&kAny);
  return usable;
}

}  // namespace

std::span<const WeightedRowsKernel* const> UsableWeightedRows() {
  static const std::vector<const WeightedRowsKernel*> usable = FindUsable();
  return usable;
}

void AddWeightedRows(std::span<const float* const> factors, const float* rows, ptrdiff_t num_rows,
                     ptrdiff_t num_cols, std::span<float* const> sums) {
  const WeightedRowsKernel& kernel = *UsableWeightedRows().front();
  for (size_t begin = 0; begin < factors.size(); begin += kMaxWeightedTogether) {
    const size_t count = std::min<size_t>(kMaxWeightedTogether, factors.size() - begin);
    kernel.add[count - 1](factors.data() + begin, rows, num_rows, num_cols, sums.data() + begin);
  }
}

}  // namespace pleat
