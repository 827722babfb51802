#include "pleat/simd/weighted_rows.h"

#include <algorithm>
#include <cstring>

namespace pleat {
namespace {

template <typename Scalar>
struct LanesOf;
template <>
struct LanesOf<float> {
  typedef float Type __attribute__((vector_size(64)));
};
template <>
struct LanesOf<double> {
  typedef double Type __attribute__((vector_size(64)));
};

// From any address: as a template argument a type would lose its alignment.
template <typename Lanes, typename Scalar>
PLEAT_ALWAYS_INLINE void Load(const Scalar* from, Lanes* lanes) {
  std::memcpy(lanes, from, sizeof(Lanes));
}

// The columns from `begin` on, in as many passes of kRegisters registers as fit; returns the first
// column left.
template <int kVectors, int kRegisters, typename Scalar>
PLEAT_ALWAYS_INLINE ptrdiff_t AddColumns(const Scalar* const* factors, const Scalar* rows,
                                         ptrdiff_t num_rows, ptrdiff_t num_cols, ptrdiff_t begin,
                                         Scalar* const* sums) {
  using Lanes = typename LanesOf<Scalar>::Type;
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

template <typename Scalar, int kVectors>
struct AddRows {
  static PLEAT_ALWAYS_INLINE void Run(const Scalar* const* factors, const Scalar* rows,
                                      ptrdiff_t num_rows, ptrdiff_t num_cols, Scalar* const* sums) {
    constexpr int kRegisters = kVectors == 1 ? 8 : 4;
    ptrdiff_t begin = AddColumns<kVectors, kRegisters>(factors, rows, num_rows, num_cols, 0, sums);
    if constexpr (kRegisters > 4) {
      begin = AddColumns<kVectors, 4>(factors, rows, num_rows, num_cols, begin, sums);
    }
    begin = AddColumns<kVectors, 2>(factors, rows, num_rows, num_cols, begin, sums);
    begin = AddColumns<kVectors, 1>(factors, rows, num_rows, num_cols, begin, sums);
    for (int q = 0; q < kVectors; ++q) {
      for (ptrdiff_t n = 0; n < num_rows; ++n) {
        for (ptrdiff_t c = begin; c < num_cols; ++c) {
          sums[q][c] += factors[q][n] * rows[n * num_cols + c];
        }
      }
    }
  }
};

template <typename Scalar, InstructionSet kSet>
constexpr WeightedRowsKernel<Scalar> KernelFor() {
  return {{CompileFor<AddRows<Scalar, 1>, kSet>(), CompileFor<AddRows<Scalar, 2>, kSet>(),
           CompileFor<AddRows<Scalar, 3>, kSet>(), CompileFor<AddRows<Scalar, 4>, kSet>()}};
}

template <typename Scalar>
void AddAll(std::span<const Scalar* const> factors, const Scalar* rows, ptrdiff_t num_rows,
            ptrdiff_t num_cols, std::span<Scalar* const> sums) {
  const WeightedRowsKernel<Scalar>& kernel = WeightedRowsVariants<Scalar>().front().kernel;
  for (size_t begin = 0; begin < factors.size(); begin += kMaxWeightedTogether) {
    const size_t count = std::min<size_t>(kMaxWeightedTogether, factors.size() - begin);
    kernel.add[count - 1](factors.data() + begin, rows, num_rows, num_cols, sums.data() + begin);
  }
}

}  // namespace

template <typename Scalar>
const KernelVariants<WeightedRowsKernel<Scalar>>& WeightedRowsVariants() {
  using enum InstructionSet;
  static const auto variants =
      RunnableVariants<WeightedRowsKernel<Scalar>>({{kAvx512, KernelFor<Scalar, kAvx512>()},
                                                    {kAvx2, KernelFor<Scalar, kAvx2>()},
                                                    {kBaseline, KernelFor<Scalar, kBaseline>()}});
  return variants;
}

template const KernelVariants<WeightedRowsKernel<float>>& WeightedRowsVariants<float>();
template const KernelVariants<WeightedRowsKernel<double>>& WeightedRowsVariants<double>();

void AddWeightedRows(std::span<const float* const> factors, const float* rows, ptrdiff_t num_rows,
                     ptrdiff_t num_cols, std::span<float* const> sums) {
  AddAll(factors, rows, num_rows, num_cols, sums);
}

void AddWeightedRows(std::span<const double* const> factors, const double* rows, ptrdiff_t num_rows,
                     ptrdiff_t num_cols, std::span<double* const> sums) {
  AddAll(factors, rows, num_rows, num_cols, sums);
}

}  // namespace pleat
