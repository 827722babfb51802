// Functions on a mesh as quantized wavelet coefficients.
#pragma once

#include "absl/status/status.h"
#include "binary_coder.h"
#include "pleat/base/progress.h"
#include "pleat/geometry/surface_hierarchy.h"

namespace pleat {

// `fields` (V x 3K): column 3 k + c is coordinate c of component k, important components first.
// Encoding reads it, both directions leave the decoded values in it. The error of the values is
// about step / sqrt(12). kInvalidArgument (encoding): a value is too large for the step. kDataLoss
// (decoding): the code is cut off.
absl::Status CodeFields(const SurfaceHierarchy& hierarchy, float step, BinaryCoder* coder,
                        FieldMatrix* fields, const Progress& progress = {});

// Where the two middle quantization cells meet: |x| < (1 - kRounding) * step becomes 0. Below 1/2,
// because zeros are cheap.
inline constexpr float kRounding = 0.35f;
// Decoded magnitudes are this much nearer to zero than the middle of their cell, in steps: within a
// cell small values are the more likely ones.
inline constexpr float kCellShift = 0.05f;

}  // namespace pleat
