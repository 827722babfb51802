#include "pleat/mesh/frame_rate.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace pleat {

FrameRate FrameRateFromFps(double fps) {
  const double ntsc = fps * 1001 / 1000;
  if (std::abs(fps - std::round(fps)) > 1e-4 && std::abs(ntsc - std::round(ntsc)) < 1e-4) {
    return {static_cast<int32_t>(std::lround(ntsc)) * 1000, 1001};
  }
  const int32_t thousandths = std::max<int32_t>(1, static_cast<int32_t>(std::lround(fps * 1000)));
  const int32_t divisor = std::gcd(thousandths, 1000);
  return {thousandths / divisor, 1000 / divisor};
}

}  // namespace pleat
