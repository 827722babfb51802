#include "cli/io/frame_rate.h"

#include <cmath>
#include <numeric>
#include <vector>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_split.h"
#include "cli/exit_code.h"

namespace pleat {

absl::StatusOr<FrameRate> ParseFrameRate(const std::string& text) {
  const absl::Status wrong = UsageError(absl::StrCat(
      "'", text, "' is not a frame rate: write 30, 29.97 or 30000/1001 (above 0, at most 10000)"));
  FrameRate rate;
  const std::vector<std::string> parts = absl::StrSplit(text, '/');
  if (parts.size() == 2) {
    if (!absl::SimpleAtoi(parts[0], &rate.numerator) ||
        !absl::SimpleAtoi(parts[1], &rate.denominator)) {
      return wrong;
    }
  } else {
    double fps;
    if (!absl::SimpleAtod(text, &fps) || !(fps > 0 && fps <= 10000)) return wrong;
    const long thousandths = std::lround(fps * 1000);
    if (std::abs(thousandths - fps * 1000) > 1e-6) return wrong;
    const long divisor = std::gcd(thousandths, 1000L);
    rate.numerator = static_cast<int32_t>(thousandths / divisor);
    rate.denominator = static_cast<int32_t>(1000 / divisor);
  }
  if (rate.numerator <= 0 || rate.denominator <= 0 || rate.fps() > 10000) return wrong;
  return rate;
}

std::string FormatFrameRate(FrameRate rate) {
  if (rate.denominator == 1) return absl::StrCat(rate.numerator);
  if (1000 % rate.denominator == 0) return absl::StrFormat("%.9g", rate.fps());
  return absl::StrCat(rate.numerator, "/", rate.denominator);
}

}  // namespace pleat
