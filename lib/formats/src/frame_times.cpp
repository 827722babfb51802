#include "frame_times.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "alembic_time.h"

namespace pleat {
namespace {

// The rates that RateOfKeys tries, the slowest first.
constexpr FrameRate kUsualRates[] = {
    {24000, 1001}, {24, 1}, {25, 1}, {30000, 1001}, {30, 1},        {48, 1},  {50, 1},
    {60000, 1001}, {60, 1}, {90, 1}, {100, 1},      {120000, 1001}, {120, 1}, {240, 1}};

// How far a time may be off because it and the first were rounded to float32, and computed by
// sums of steps in some exporters.
double RoundingOf(const std::vector<float>& times_s) {
  const double largest =
      std::max(std::abs(double{times_s.front()}), std::abs(double{times_s.back()}));
  return 4 * largest * std::numeric_limits<float>::epsilon() + 1e-9;
}

bool AreAscending(const std::vector<float>& times_s) {
  for (size_t i = 0; i < times_s.size(); ++i) {
    if (!std::isfinite(times_s[i]) || (i > 0 && !(times_s[i] > times_s[i - 1]))) return false;
  }
  return true;
}

bool FitsEveryFrame(const std::vector<float>& times_s, FrameRate rate) {
  const double rounding = RoundingOf(times_s);
  for (size_t i = 0; i < times_s.size(); ++i) {
    const double expected = double{times_s[0]} + static_cast<double>(i) / rate.fps();
    if (!(std::abs(times_s[i] - expected) <= rounding)) return false;
  }
  return true;
}

}  // namespace

std::optional<FrameRate> RateOfFloatTimes(const std::vector<float>& times_s) {
  if (times_s.size() < 2 || !AreAscending(times_s)) return std::nullopt;
  const double step =
      (double{times_s.back()} - times_s.front()) / static_cast<double>(times_s.size() - 1);
  for (const FrameRate rate : kUsualRates) {
    if (std::abs(step * rate.fps() - 1) < 1e-2 && FitsEveryFrame(times_s, rate)) return rate;
  }
  const double whole = std::round(1 / step);
  if (whole >= 1 && whole <= 10'000) {
    const FrameRate rate{static_cast<int32_t>(whole), 1};
    if (FitsEveryFrame(times_s, rate)) return rate;
  }
  return RateOfTimes(std::vector<double>(times_s.begin(), times_s.end()));
}

std::optional<FrameRate> RateOfKeys(const std::vector<float>& times_s) {
  if (times_s.size() < 2 || !AreAscending(times_s)) return std::nullopt;
  const double rounding = std::max(RoundingOf(times_s), 1e-5);
  for (const FrameRate rate : kUsualRates) {
    const bool fits = std::ranges::all_of(times_s, [&](float time) {
      const double frame = (double{time} - times_s[0]) * rate.fps();
      return std::abs(frame - std::round(frame)) <= rounding * rate.fps();
    });
    if (fits) return rate;
  }
  return std::nullopt;
}

std::optional<FrameRate> RateOfInterval(double seconds, double tolerance_s) {
  const auto distance = [&](FrameRate rate) { return std::abs(seconds - 1 / rate.fps()); };
  std::optional<FrameRate> nearest;
  for (const bool is_whole : {true, false}) {
    for (const FrameRate rate : kUsualRates) {
      if ((rate.denominator == 1) != is_whole || distance(rate) > tolerance_s) continue;
      if (!nearest || distance(rate) < distance(*nearest)) nearest = rate;
    }
    if (nearest) break;
  }
  return nearest;
}

double FrameNumberAt(float seconds, FrameRate rate) {
  const double frame = double{seconds} * rate.fps();
  const double rounding =
      std::max(1e-5, 2 * std::abs(frame) * std::numeric_limits<float>::epsilon());
  return std::abs(frame - std::round(frame)) <= rounding ? std::round(frame) : frame;
}

}  // namespace pleat
