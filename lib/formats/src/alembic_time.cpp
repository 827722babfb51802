#include "alembic_time.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

constexpr double kSameTime_s = 1e-5;

absl::Status CheckStoredTimes(const AlembicTimeSampling& sampling, size_t number) {
  const std::vector<double>& times = sampling.times;
  for (size_t i = 0; i < times.size(); ++i) {
    if (!std::isfinite(times[i])) {
      return absl::InvalidArgumentError(
          absl::StrCat("time ", i, " of time sampling ", number, " is not finite"));
    }
    if (i > 0 && !(times[i] > times[i - 1])) {
      return absl::InvalidArgumentError(absl::StrCat("time ", i, " of time sampling ", number, " (",
                                                     times[i], " s) is not after the one before (",
                                                     times[i - 1], " s)"));
    }
  }
  if (sampling.is_acyclic()) return absl::OkStatus();
  const double cycle = sampling.seconds_per_cycle;
  if (!(cycle > 0 && std::isfinite(cycle)) || times.back() - times.front() > cycle) {
    return absl::InvalidArgumentError(absl::StrCat("time sampling ", number, " has a cycle of ",
                                                   cycle, " s for ", times.size(), " times over ",
                                                   times.back() - times.front(), " s"));
  }
  return absl::OkStatus();
}

// Whether numerator / denominator frames per second have that step, to the given relative error.
bool IsRate(double numerator, double denominator, double seconds, double tolerance) {
  return std::abs(seconds * numerator / denominator - 1) <= tolerance;
}

// The first convergent of the continued fraction of `seconds` that equals it to the last bits.
std::optional<FrameRate> ExactRate(double seconds) {
  constexpr double kMaxTerm = 1'000'000;
  constexpr double kLastBits = 4 * std::numeric_limits<double>::epsilon();
  // Convergents of the step are denominator / numerator of the rate.
  double numerator = 0, denominator = 1, last_numerator = 1, last_denominator = 0;
  double rest = seconds;
  for (int i = 0; i < 40; ++i) {
    const double whole = std::floor(rest);
    const double next_denominator = whole * denominator + last_denominator;
    const double next_numerator = whole * numerator + last_numerator;
    last_denominator = std::exchange(denominator, next_denominator);
    last_numerator = std::exchange(numerator, next_numerator);
    if (numerator > kMaxTerm || denominator > kMaxTerm) return std::nullopt;
    if (denominator > 0 && IsRate(numerator, denominator, seconds, kLastBits)) {
      return FrameRate{static_cast<int32_t>(numerator), static_cast<int32_t>(denominator)};
    }
    if (rest == whole) return std::nullopt;
    rest = 1 / (rest - whole);
  }
  return std::nullopt;
}

}  // namespace

const double kAcyclicSeconds = std::numeric_limits<double>::max() / 32;

absl::StatusOr<std::vector<AlembicTimeSampling>> ParseTimeSamplings(std::string_view bytes) {
  std::vector<AlembicTimeSampling> samplings;
  ByteReader reader(bytes);
  while (reader.remaining() > 0) {
    PLEAT_RETURN_IF_ERROR(reader.Read<uint32_t>("the samples of a time sampling").status());
    AlembicTimeSampling sampling;
    PLEAT_ASSIGN_OR_RETURN(sampling.seconds_per_cycle, reader.Read<double>("a time per cycle"));
    PLEAT_ASSIGN_OR_RETURN(const uint32_t num_times, reader.Read<uint32_t>("a number of times"));
    PLEAT_RETURN_IF_ERROR(reader.Require(num_times, sizeof(double), "the times of a sampling"));
    if (num_times == 0) {
      return absl::InvalidArgumentError(
          absl::StrCat("time sampling ", samplings.size(), " has no time"));
    }
    sampling.times.resize(num_times);
    PLEAT_RETURN_IF_ERROR(
        reader.ReadArray(std::span<double>(sampling.times), "the times of a sampling"));
    PLEAT_RETURN_IF_ERROR(CheckStoredTimes(sampling, samplings.size()));
    samplings.push_back(std::move(sampling));
  }
  return samplings;
}

void WriteTimeSampling(const AlembicTimeSampling& sampling, uint32_t max_samples,
                       ByteWriter* writer) {
  writer->Write(max_samples);
  writer->Write(sampling.seconds_per_cycle);
  writer->Write(static_cast<uint32_t>(sampling.times.size()));
  writer->WriteArray(std::span<const double>(sampling.times));
}

double AlembicTimeSampling::TimeOf(int sample) const {
  if (is_acyclic()) return times[sample];
  const int num_stored = static_cast<int>(times.size());
  return times[sample % num_stored] + seconds_per_cycle * (sample / num_stored);
}

std::vector<double> AlembicTimes::All() const {
  std::vector<double> seconds;
  for (int i = 0; i < num_samples; ++i) seconds.push_back(TimeOf(i));
  return seconds;
}

absl::Status CheckTimes(const AlembicTimes& times) {
  const auto num_stored = static_cast<int>(times.sampling->times.size());
  if (!times.sampling->is_acyclic() || times.num_samples <= num_stored) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(
      "there are ", times.num_samples, " samples but only ", num_stored, " acyclic times"));
}

TimePlace FindTime(const AlembicTimes& times, double seconds) {
  // The first sample that is later.
  int low = 0, after = times.num_samples;
  while (low < after) {
    const int middle = low + (after - low) / 2;
    if (times.TimeOf(middle) > seconds) {
      after = middle;
    } else {
      low = middle + 1;
    }
  }
  if (after == 0) return {};
  const int before = after - 1;
  const double begin = times.TimeOf(before);
  if (after == times.num_samples || seconds - begin <= kSameTime_s) return {before, before, 0};
  const double end = times.TimeOf(after);
  if (end - seconds <= kSameTime_s) return {after, after, 0};
  return {before, after, (seconds - begin) / (end - begin)};
}

bool AreSameTimes(const AlembicTimes& a, const AlembicTimes& b) {
  if (a.num_samples != b.num_samples) return false;
  if (a.sampling == b.sampling) return true;
  for (int i = 0; i < a.num_samples; ++i) {
    if (!(std::abs(a.TimeOf(i) - b.TimeOf(i)) <= kSameTime_s)) return false;
  }
  return true;
}

std::optional<FrameRate> RateOfTimes(const std::vector<double>& times) {
  constexpr double kEven = 1e-3;
  const double step = (times.back() - times.front()) / static_cast<double>(times.size() - 1);
  for (size_t i = 1; i < times.size(); ++i) {
    if (!(std::abs(times[i] - times[i - 1] - step) <= kEven * step)) return std::nullopt;
  }
  return RateOfStep(step);
}

std::optional<FrameRate> RateOfStep(double seconds) {
  if (!(seconds >= 1e-4 && seconds <= 1e3)) return std::nullopt;
  if (const std::optional<FrameRate> exact = ExactRate(seconds)) return exact;
  // Times went through single precision, or through a frame rate in decimals, in many exporters.
  // 23.976 and 24000/1001 differ by a millionth.
  constexpr double kRounding = 4e-7;
  const double fps = 1 / seconds;
  if (IsRate(std::round(fps), 1, seconds, kRounding)) {
    return FrameRate{static_cast<int32_t>(std::lround(fps)), 1};
  }
  const double ntsc = std::round(fps * 1.001);
  if (IsRate(ntsc * 1000, 1001, seconds, kRounding)) {
    return FrameRate{static_cast<int32_t>(ntsc) * 1000, 1001};
  }
  const auto thousandths = static_cast<int32_t>(std::max(1L, std::lround(fps * 1000)));
  const int32_t divisor = std::gcd(thousandths, 1000);
  return FrameRate{thousandths / divisor, 1000 / divisor};
}

}  // namespace pleat
