#include "pleat/simd/round_weights.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace pleat {
namespace {

constexpr ptrdiff_t kLanes = 8;
constexpr double kLargestWeight = 32767, kLargestSum = 2147483647, kLargestValue = 127;

typedef float Floats __attribute__((vector_size(32)));
typedef double Lanes __attribute__((vector_size(64)));
typedef int32_t Integers __attribute__((vector_size(32)));
typedef int16_t Weights __attribute__((vector_size(16)));

struct RoundAll {
  static PLEAT_ALWAYS_INLINE Lanes Products(const float* scales, const float* coefficients) {
    Floats s, c;
    std::memcpy(&s, scales, sizeof(s));
    std::memcpy(&c, coefficients, sizeof(c));
    return __builtin_convertvector(s, Lanes) * __builtin_convertvector(c, Lanes);
  }

  // What is left after the last whole register, filled up with zeros.
  struct Rest {
    float scales[kLanes] = {}, coefficients[kLanes] = {};
  };
  static PLEAT_ALWAYS_INLINE Rest RestOf(const float* scales, const float* coefficients,
                                         ptrdiff_t begin, ptrdiff_t count) {
    Rest rest;
    for (ptrdiff_t p = begin; p < count; ++p) {
      rest.scales[p - begin] = scales[p];
      rest.coefficients[p - begin] = coefficients[p];
    }
    return rest;
  }

  static PLEAT_ALWAYS_INLINE void Measure(Lanes product, Lanes* largest, Lanes* total) {
    const Lanes size = product < 0 ? -product : product;
    *largest = size > *largest ? size : *largest;
    *total += size;
  }

  static PLEAT_ALWAYS_INLINE Weights Rounded(Lanes product, double unit) {
    Lanes quotient = product / unit;
    // The conversion cuts off.
    quotient += quotient < 0 ? Lanes{} - .5 : Lanes{} + .5;
    quotient = quotient > kLargestWeight ? Lanes{} + kLargestWeight : quotient;
    quotient = quotient < -kLargestWeight ? Lanes{} - kLargestWeight : quotient;
    return __builtin_convertvector(__builtin_convertvector(quotient, Integers), Weights);
  }

  static PLEAT_ALWAYS_INLINE float Run(const float* scales, const float* coefficients,
                                       ptrdiff_t count, int16_t* weights) {
    const ptrdiff_t whole = count / kLanes * kLanes;
    const Rest rest = RestOf(scales, coefficients, whole, count);
    const Lanes last = Products(rest.scales, rest.coefficients);
    Lanes largest = {}, total = {};
    for (ptrdiff_t p = 0; p < whole; p += kLanes) {
      Measure(Products(scales + p, coefficients + p), &largest, &total);
    }
    Measure(last, &largest, &total);
    double most = 0, sum = 0;
    for (int lane = 0; lane < kLanes; ++lane) {
      most = std::max(most, largest[lane]);
      sum += total[lane];
    }
    // Every weight may round up by a half.
    const double room = kLargestSum / kLargestValue - static_cast<double>(count);
    const double unit = std::max(most / kLargestWeight, sum / room);
    // The sum also says when a product is not finite.
    if (!(unit > 0) || !std::isfinite(sum)) {
      std::fill_n(weights, count, int16_t{0});
      return 0;
    }
    for (ptrdiff_t p = 0; p < whole; p += kLanes) {
      const Weights rounded = Rounded(Products(scales + p, coefficients + p), unit);
      std::memcpy(weights + p, &rounded, sizeof(rounded));
    }
    const Weights rounded = Rounded(last, unit);
    for (ptrdiff_t p = whole; p < count; ++p) weights[p] = rounded[p - whole];
    return static_cast<float>(unit);
  }
};

}  // namespace

const KernelVariants<RoundWeightsFunction>& RoundWeightsVariants() {
  static const auto variants = CompiledVariants<RoundAll>();
  return variants;
}

}  // namespace pleat
