#include "expand_planes.h"

#include <cstring>
#include <vector>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace pleat {
namespace {

// Two weights as the 32 bits that multiply a pair of values.
inline int32_t PairOf(const int16_t* weights, ptrdiff_t pair) {
  int32_t both;
  std::memcpy(&both, weights + 2 * pair, sizeof(both));
  return both;
}

template <int kQueries>
void ExpandPortably(const int8_t* values, const float* mean, ptrdiff_t num_pairs,
                    const int16_t* const* weights, const float* units, float* const* details) {
  for (int q = 0; q < kQueries; ++q) {
    int32_t sums[kPlaneLanes] = {};
    for (ptrdiff_t p = 0; p < num_pairs; ++p) {
      const int8_t* pair = values + p * 2 * kPlaneLanes;
      const int32_t first = weights[q][2 * p], second = weights[q][2 * p + 1];
      for (int l = 0; l < kPlaneLanes; ++l) {
        sums[l] += first * pair[2 * l] + second * pair[2 * l + 1];
      }
    }
    for (int l = 0; l < kPlaneLanes; ++l) {
      details[q][l] = mean[l] + units[q] * static_cast<float>(sums[l]);
    }
  }
}

constexpr PlaneKernel kPortable = {
    "portable", {ExpandPortably<1>, ExpandPortably<2>, ExpandPortably<3>, ExpandPortably<4>}};

#if defined(__x86_64__)

template <int kQueries>
__attribute__((target("avx2"))) void ExpandAvx2(const int8_t* values, const float* mean,
                                                ptrdiff_t num_pairs, const int16_t* const* weights,
                                                const float* units, float* const* details) {
  __m256i sums[kQueries][2];
  for (auto& sum : sums) sum[0] = sum[1] = _mm256_setzero_si256();
  for (ptrdiff_t p = 0; p < num_pairs; ++p) {
    const auto* pair = reinterpret_cast<const __m128i*>(values + p * 2 * kPlaneLanes);
    const __m256i low = _mm256_cvtepi8_epi16(_mm_loadu_si128(pair));
    const __m256i high = _mm256_cvtepi8_epi16(_mm_loadu_si128(pair + 1));
    for (int q = 0; q < kQueries; ++q) {
      const __m256i weight = _mm256_set1_epi32(PairOf(weights[q], p));
      sums[q][0] = _mm256_add_epi32(sums[q][0], _mm256_madd_epi16(low, weight));
      sums[q][1] = _mm256_add_epi32(sums[q][1], _mm256_madd_epi16(high, weight));
    }
  }
  for (int q = 0; q < kQueries; ++q) {
    for (int half = 0; half < 2; ++half) {
      const __m256 scaled =
          _mm256_mul_ps(_mm256_set1_ps(units[q]), _mm256_cvtepi32_ps(sums[q][half]));
      _mm256_storeu_ps(details[q] + 8 * half,
                       _mm256_add_ps(_mm256_loadu_ps(mean + 8 * half), scaled));
    }
  }
}

constexpr PlaneKernel kAvx2 = {"avx2",
                               {ExpandAvx2<1>, ExpandAvx2<2>, ExpandAvx2<3>, ExpandAvx2<4>}};

template <int kQueries>
__attribute__((target("avx512bw"))) void ExpandAvx512(const int8_t* values, const float* mean,
                                                      ptrdiff_t num_pairs,
                                                      const int16_t* const* weights,
                                                      const float* units, float* const* details) {
  __m512i sums[kQueries];
  for (__m512i& sum : sums) sum = _mm512_setzero_si512();
  for (ptrdiff_t p = 0; p < num_pairs; ++p) {
    const __m512i pair = _mm512_cvtepi8_epi16(
        _mm256_loadu_si256(reinterpret_cast<const __m256i*>(values + p * 2 * kPlaneLanes)));
    for (int q = 0; q < kQueries; ++q) {
      const __m512i weight = _mm512_set1_epi32(PairOf(weights[q], p));
      sums[q] = _mm512_add_epi32(sums[q], _mm512_madd_epi16(pair, weight));
    }
  }
  for (int q = 0; q < kQueries; ++q) {
    // The plain conversion reads an undefined register, of which gcc 12 warns.
    const __m512 scaled =
        _mm512_mul_ps(_mm512_set1_ps(units[q]), _mm512_maskz_cvtepi32_ps(0xffff, sums[q]));
    _mm512_storeu_ps(details[q], _mm512_add_ps(_mm512_loadu_ps(mean), scaled));
  }
}

constexpr PlaneKernel kAvx512 = {
    "avx512", {ExpandAvx512<1>, ExpandAvx512<2>, ExpandAvx512<3>, ExpandAvx512<4>}};

#endif

std::vector<const PlaneKernel*> FindUsable() {
  std::vector<const PlaneKernel*> usable;
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512bw")) usable.push_back(&kAvx512);
  if (__builtin_cpu_supports("avx2")) usable.push_back(&kAvx2);
#endif
  usable.push_back(&kPortable);
  return usable;
}

}  // namespace

std::span<const PlaneKernel* const> UsablePlaneKernels() {
  static const std::vector<const PlaneKernel*> usable = FindUsable();
  return usable;
}

}  // namespace pleat
