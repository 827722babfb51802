#include "pleat/stream/stream_header.h"

#include <cmath>

#include "absl/strings/str_cat.h"

namespace pleat {

absl::Status QuantizationBox::Validate() const {
  if (bits < kMinBits || bits > kMaxBits) {
    return absl::InvalidArgumentError(
        absl::StrCat("position_bits is ", bits, ", allowed are ", kMinBits, " to ", kMaxBits));
  }
  if (!origin_m.allFinite() || origin_m.cwiseAbs().maxCoeff() > 1e9f) {
    return absl::InvalidArgumentError("the origin of the quantization box is not a finite point");
  }
  if (!(range_m > 1e-9f && range_m < 1e9f)) {
    return absl::InvalidArgumentError(absl::StrCat("the edge of the quantization box is ", range_m,
                                                   " m, allowed is 1e-9 to 1e9"));
  }
  return absl::OkStatus();
}

}  // namespace pleat
