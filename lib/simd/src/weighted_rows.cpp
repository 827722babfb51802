// The same code is compiled for three instruction sets: it is inlined into each function.
#include "pleat/simd/weighted_rows.h"

#include <algorithm>
#include <cstring>
#include <vector>

#include "pleat/simd/cpu_target.h"

namespace pleat {
namespace {

typedef float FloatLanes __attribute__((vector_size(64)));
typedef double DoubleLanes __attribute__((vector_size(64)));

// From any address: as a template argument a type would lose its alignment.
template <typename Lanes, typename Scalar>
inline __attribute__((always_inline)) void Load(const Scalar* from, Lanes* lanes) {
  std::memcpy(lanes, from, sizeof(Lanes));
}

// The columns from `begin` on, in as many passes of kRegisters registers as fit; returns the first
// column left.
template <int kVectors, int kRegisters, typename Lanes, typename Scalar>
inline __attribute__((always_inline)) ptrdiff_t AddColumns(const Scalar* const* factors,
                                                           const Scalar* rows, ptrdiff_t num_rows,
                                                           ptrdiff_t num_cols, ptrdiff_t begin,
                                                           Scalar* const* sums) {
  constexpr ptrdiff_t kLanes = sizeof(Lanes) / sizeof(Scalar);
  for (; begin + kLanes * kRegisters <= num_cols; begin += kLanes * kRegisters) {
    Lanes block[kVectors][kRegisters];
#pragma GCC unroll 4
    for (int q = 0; q < kVectors; ++q) {
#pragma GCC unroll 8
      for (ptrdiff_t i = 0; i < kRegisters; ++i) {
        Load(sums[q] + begin + i * kLanes, &block[q][i]);
      }
    }
    for (ptrdiff_t n = 0; n < num_rows; ++n) {
#pragma GCC unroll 8
      for (ptrdiff_t i = 0; i < kRegisters; ++i) {
        Lanes row;
        Load(rows + n * num_cols + begin + i * kLanes, &row);
#pragma GCC unroll 4
        for (int q = 0; q < kVectors; ++q) block[q][i] += factors[q][n] * row;
      }
    }
#pragma GCC unroll 4
    for (int q = 0; q < kVectors; ++q) {
#pragma GCC unroll 8
      for (ptrdiff_t i = 0; i < kRegisters; ++i) {
        std::memcpy(sums[q] + begin + i * kLanes, &block[q][i], sizeof(Lanes));
      }
    }
  }
  return begin;
}

template <int kVectors, typename Lanes, typename Scalar>
inline __attribute__((always_inline)) void Add(const Scalar* const* factors, const Scalar* rows,
                                               ptrdiff_t num_rows, ptrdiff_t num_cols,
                                               Scalar* const* sums) {
  constexpr int kRegisters = kVectors == 1 ? 8 : 4;
  ptrdiff_t begin =
      AddColumns<kVectors, kRegisters, Lanes>(factors, rows, num_rows, num_cols, 0, sums);
  begin = AddColumns<kVectors, 1, Lanes>(factors, rows, num_rows, num_cols, begin, sums);
  for (int q = 0; q < kVectors; ++q) {
    for (ptrdiff_t n = 0; n < num_rows; ++n) {
      for (ptrdiff_t c = begin; c < num_cols; ++c) {
        sums[q][c] += factors[q][n] * rows[n * num_cols + c];
      }
    }
  }
}

template <int kVectors, typename Lanes, typename Scalar>
void AddForAny(const Scalar* const* factors, const Scalar* rows, ptrdiff_t num_rows,
               ptrdiff_t num_cols, Scalar* const* sums) {
  Add<kVectors, Lanes>(factors, rows, num_rows, num_cols, sums);
}

#if defined(__x86_64__)
template <int kVectors, typename Lanes, typename Scalar>
__attribute__((target("avx2"))) void AddForAvx2(const Scalar* const* factors, const Scalar* rows,
                                                ptrdiff_t num_rows, ptrdiff_t num_cols,
                                                Scalar* const* sums) {
  Add<kVectors, Lanes>(factors, rows, num_rows, num_cols, sums);
}

template <int kVectors, typename Lanes, typename Scalar>
PLEAT_TARGET_AVX512("avx512f")
void AddForAvx512(const Scalar* const* factors, const Scalar* rows, ptrdiff_t num_rows,
                  ptrdiff_t num_cols, Scalar* const* sums) {
  Add<kVectors, Lanes>(factors, rows, num_rows, num_cols, sums);
}
#endif

template <typename Scalar, typename Lanes>
std::vector<const WeightedRowsKernel<Scalar>*> FindUsable() {
  static constexpr WeightedRowsKernel<Scalar> kAny = {
      {AddForAny<1, Lanes, Scalar>, AddForAny<2, Lanes, Scalar>, AddForAny<3, Lanes, Scalar>,
       AddForAny<4, Lanes, Scalar>}};
  std::vector<const WeightedRowsKernel<Scalar>*> usable;
#if defined(__x86_64__)
  static constexpr WeightedRowsKernel<Scalar> kAvx2 = {
      {AddForAvx2<1, Lanes, Scalar>, AddForAvx2<2, Lanes, Scalar>, AddForAvx2<3, Lanes, Scalar>,
       AddForAvx2<4, Lanes, Scalar>}};
  static constexpr WeightedRowsKernel<Scalar> kAvx512 = {
      {AddForAvx512<1, Lanes, Scalar>, AddForAvx512<2, Lanes, Scalar>,
       AddForAvx512<3, Lanes, Scalar>, AddForAvx512<4, Lanes, Scalar>}};
  if (__builtin_cpu_supports("avx512f")) usable.push_back(&kAvx512);
  if (__builtin_cpu_supports("avx2")) usable.push_back(&kAvx2);
#endif
  usable.push_back(&kAny);
  return usable;
}

template <typename Scalar>
void AddAll(std::span<const Scalar* const> factors, const Scalar* rows, ptrdiff_t num_rows,
            ptrdiff_t num_cols, std::span<Scalar* const> sums) {
  const WeightedRowsKernel<Scalar>& kernel = *UsableWeightedRows<Scalar>().front();
  for (size_t begin = 0; begin < factors.size(); begin += kMaxWeightedTogether) {
    const size_t count = std::min<size_t>(kMaxWeightedTogether, factors.size() - begin);
    kernel.add[count - 1](factors.data() + begin, rows, num_rows, num_cols, sums.data() + begin);
  }
}

}  // namespace

template <>
std::span<const WeightedRowsKernel<float>* const> UsableWeightedRows<float>() {
  static const auto usable = FindUsable<float, FloatLanes>();
  return usable;
}

template <>
std::span<const WeightedRowsKernel<double>* const> UsableWeightedRows<double>() {
  static const auto usable = FindUsable<double, DoubleLanes>();
  return usable;
}

void AddWeightedRows(std::span<const float* const> factors, const float* rows, ptrdiff_t num_rows,
                     ptrdiff_t num_cols, std::span<float* const> sums) {
  AddAll(factors, rows, num_rows, num_cols, sums);
}

void AddWeightedRows(std::span<const double* const> factors, const double* rows, ptrdiff_t num_rows,
                     ptrdiff_t num_cols, std::span<double* const> sums) {
  AddAll(factors, rows, num_rows, num_cols, sums);
}

}  // namespace pleat
