#include "ticks.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_format.h"

namespace pleat {

std::vector<double> RoundTicks(double low, double high, int wanted) {
  const double rough = (high - low) / std::max(wanted, 1);
  const double power = std::pow(10, std::floor(std::log10(rough)));
  double step = 10 * power;
  for (double factor : {5., 2., 1.}) {
    if (factor * power >= rough * .999) step = factor * power;
  }
  std::vector<double> ticks;
  for (double k = std::ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; ++k) {
    ticks.push_back(k * step);
  }
  return ticks;
}

std::string TickLabel(double value, double step) {
  const int digits = std::max(0, static_cast<int>(std::ceil(-std::log10(step) - 1e-9)));
  return absl::StrFormat("%.*f", digits, value == 0 ? 0.0 : value);
}

}  // namespace pleat
