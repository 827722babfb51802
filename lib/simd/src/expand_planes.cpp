#include "pleat/simd/expand_planes.h"

#include <cstring>

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
    int32_t sums[kPlaneRows] = {};
    for (ptrdiff_t p = 0; p < num_pairs; ++p) {
      const int8_t* pair = values + p * 2 * kPlaneRows;
      const int32_t first = weights[q][2 * p], second = weights[q][2 * p + 1];
      for (int l = 0; l < kPlaneRows; ++l) {
        sums[l] += first * pair[2 * l] + second * pair[2 * l + 1];
      }
    }
    for (int l = 0; l < kPlaneRows; ++l) {
      details[q][l] = mean[l] + units[q] * static_cast<float>(sums[l]);
    }
  }
}

constexpr PlaneKernel kPortable = {
    {ExpandPortably<1>, ExpandPortably<2>, ExpandPortably<3>, ExpandPortably<4>}};

#if defined(__x86_64__)

template <int kQueries>
PLEAT_TARGET_AVX2 void ExpandAvx2(const int8_t* values, const float* mean, ptrdiff_t num_pairs,
                                  const int16_t* const* weights, const float* units,
                                  float* const* details) {
  // 16 rows at a time, so that all sums stay in registers.
  for (int begin = 0; begin < kPlaneRows; begin += 16) {
    __m256i sums[kQueries][2];
    for (auto& sum : sums) sum[0] = sum[1] = _mm256_setzero_si256();
    for (ptrdiff_t p = 0; p < num_pairs; ++p) {
      const auto* pair = reinterpret_cast<const __m128i*>(values + 2 * (p * kPlaneRows + begin));
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
        const int place = begin + 8 * half;
        const __m256 scaled =
            _mm256_mul_ps(_mm256_set1_ps(units[q]), _mm256_cvtepi32_ps(sums[q][half]));
        _mm256_storeu_ps(details[q] + place, _mm256_add_ps(_mm256_loadu_ps(mean + place), scaled));
      }
    }
  }
}

constexpr PlaneKernel kForAvx2 = {{ExpandAvx2<1>, ExpandAvx2<2>, ExpandAvx2<3>, ExpandAvx2<4>}};

PLEAT_TARGET_AVX512 inline __m512i LoadPair(const int8_t* values) {
  return _mm512_cvtepi8_epi16(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(values)));
}

PLEAT_TARGET_AVX512 inline void StoreDetails(__m512i sums, float unit, const float* mean,
                                             float* details) {
  // The plain conversion reads an undefined register, of which gcc 12 warns.
  const __m512 scaled = _mm512_mul_ps(_mm512_set1_ps(unit), _mm512_maskz_cvtepi32_ps(0xffff, sums));
  _mm512_storeu_ps(details, _mm512_add_ps(_mm512_loadu_ps(mean), scaled));
}

template <int kQueries>
PLEAT_TARGET_AVX512 void ExpandAvx512(const int8_t* values, const float* mean, ptrdiff_t num_pairs,
                                      const int16_t* const* weights, const float* units,
                                      float* const* details) {
  __m512i sums[kQueries][3];
  for (auto& sum : sums) sum[0] = sum[1] = sum[2] = _mm512_setzero_si512();
  for (ptrdiff_t p = 0; p < num_pairs; ++p) {
    for (int third = 0; third < 3; ++third) {
      const __m512i pair = LoadPair(values + 2 * (p * kPlaneRows + 16 * third));
      for (int q = 0; q < kQueries; ++q) {
        const __m512i weight = _mm512_set1_epi32(PairOf(weights[q], p));
        sums[q][third] = _mm512_add_epi32(sums[q][third], _mm512_madd_epi16(pair, weight));
      }
    }
  }
  for (int q = 0; q < kQueries; ++q) {
    for (int third = 0; third < 3; ++third) {
      StoreDetails(sums[q][third], units[q], mean + 16 * third, details[q] + 16 * third);
    }
  }
}

constexpr PlaneKernel kForAvx512 = {
    {ExpandAvx512<1>, ExpandAvx512<2>, ExpandAvx512<3>, ExpandAvx512<4>}};

// One instruction multiplies and adds, but five cycles pass until its sum can be added to: twelve
// sums side by side, or six of one or two queries.
template <int kQueries>
PLEAT_TARGET_AVX512_VNNI void ExpandVnni(const int8_t* values, const float* mean,
                                         ptrdiff_t num_pairs, const int16_t* const* weights,
                                         const float* units, float* const* details) {
  __m512i sums[kQueries][3];
#pragma GCC unroll 4
  for (auto& sum : sums) sum[0] = sum[1] = sum[2] = _mm512_setzero_si512();
  for (ptrdiff_t p = 0; p < num_pairs; ++p) {
    const int8_t* pair = values + 2 * p * kPlaneRows;
    const __m512i x = LoadPair(pair), y = LoadPair(pair + 32), z = LoadPair(pair + 64);
#pragma GCC unroll 4
    for (int q = 0; q < kQueries; ++q) {
      const __m512i weight = _mm512_set1_epi32(PairOf(weights[q], p));
      sums[q][0] = _mm512_dpwssd_epi32(sums[q][0], x, weight);
      sums[q][1] = _mm512_dpwssd_epi32(sums[q][1], y, weight);
      sums[q][2] = _mm512_dpwssd_epi32(sums[q][2], z, weight);
    }
  }
#pragma GCC unroll 4
  for (int q = 0; q < kQueries; ++q) {
#pragma GCC unroll 3
    for (int third = 0; third < 3; ++third) {
      StoreDetails(sums[q][third], units[q], mean + 16 * third, details[q] + 16 * third);
    }
  }
}

constexpr PlaneKernel kForVnni = {{ExpandVnni<1>, ExpandVnni<2>, ExpandVnni<3>, ExpandVnni<4>}};

#endif

}  // namespace

const KernelVariants<PlaneKernel>& PlaneVariants() {
  using enum InstructionSet;
  static const auto variants = RunnableVariants<PlaneKernel>({
#if defined(__x86_64__)
    {kAvx512Vnni, kForVnni}, {kAvx512, kForAvx512}, {kAvx2, kForAvx2},
#endif
        {kBaseline, kPortable},
  });
  return variants;
}

}  // namespace pleat
