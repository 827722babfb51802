// Sums of integer planes, on the widest registers of this processor.
#pragma once

#include <cstddef>
#include <cstdint>

#include "pleat/simd/dispatch.h"

namespace pleat {

inline constexpr int kPlaneRows = 48;   // rows of a block
inline constexpr int kMaxTogether = 4;  // queries that are summed in one pass

// details[q][l] = mean[l] + units[q] * sum_p weights[q][p] values[p / 2][l][p % 2] for one block of
// 48 rows l: values are num_pairs x 48 x 2, weights[q] 2 num_pairs. The sums must fit in 32 bits.
// All kernels give the same bits.
struct PlaneKernel {
  // [k]: for k + 1 queries.
  using Function = void (*)(const int8_t* values, const float* mean, ptrdiff_t num_pairs,
                            const int16_t* const* weights, const float* units,
                            float* const* details);
  Function expand[kMaxTogether];
};

// Those this processor can run, the fastest first.
const KernelVariants<PlaneKernel>& PlaneVariants();

}  // namespace pleat
