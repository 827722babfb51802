// The weights of a sum of integer planes (expand_planes.h), on the widest registers of this
// processor.
#pragma once

#include <cstddef>
#include <cstdint>

#include "pleat/simd/dispatch.h"

namespace pleat {

// Rounds the products x_p = scales[p] * coefficients[p] to weights[p] = x_p / unit, halves away
// from zero, and returns the unit: as fine as 16 bits of a weight allow, and sums of weights times
// values of at most 127 in 32 bits. All weights are 0, and so is the unit, when the products are
// all zero or one is not finite. All kernels give the same bits.
using RoundWeightsFunction = float (*)(const float* scales, const float* coefficients,
                                       ptrdiff_t count, int16_t* weights);

// Those this processor can run, the fastest first.
const KernelVariants<RoundWeightsFunction>& RoundWeightsVariants();

}  // namespace pleat
