// When the samples of an Alembic property are, and which frame rate that is.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/base/bytes.h"
#include "pleat/mesh/mesh_sequence.h"

namespace pleat {

// The seconds per cycle of acyclic times, DBL_MAX / 32.
extern const double kAcyclicSeconds;

// The times of samples 0, 1, ...: one stored time is uniform, several are the times of one cycle,
// or all times that there are.
struct AlembicTimeSampling {
  double seconds_per_cycle = 1;
  std::vector<double> times = {0};  // seconds, ascending, at least one

  bool is_acyclic() const { return seconds_per_cycle == kAcyclicSeconds; }
  bool is_uniform() const { return !is_acyclic() && times.size() == 1; }
  // Seconds. Of acyclic times there must be as many.
  double TimeOf(int sample) const;
  friend bool operator==(const AlembicTimeSampling&, const AlembicTimeSampling&) = default;
};

// All time samplings of an archive. kDataLoss when the bytes end within one, kInvalidArgument for
// times that are not finite or do not ascend, and for a cycle that is not positive.
absl::StatusOr<std::vector<AlembicTimeSampling>> ParseTimeSamplings(std::string_view bytes);
void WriteTimeSampling(const AlembicTimeSampling& sampling, uint32_t max_samples,
                       ByteWriter* writer);

// The first samples of a time sampling: when those of one property are. The sampling must outlive
// it.
struct AlembicTimes {
  const AlembicTimeSampling* sampling = nullptr;
  uint32_t number = 0;  // of the sampling in the archive
  int num_samples = 1;

  double TimeOf(int sample) const { return sampling->TimeOf(sample); }
  std::vector<double> All() const;
};

// kInvalidArgument when the acyclic times are fewer than the samples.
absl::Status CheckTimes(const AlembicTimes& times);

// Between which samples a time lies; before == after where it is that of a sample, to 10
// microseconds, or outside of all.
struct TimePlace {
  int before = 0, after = 0;
  double weight = 0;  // of `after`
};
TimePlace FindTime(const AlembicTimes& times, double seconds);

// True when as many samples are at the same times, to 10 microseconds.
bool AreSameTimes(const AlembicTimes& a, const AlembicTimes& b);

// The frame rate of evenly spaced times, none when they are not even to a thousandth of their step
// or are no rate that a sequence can have. At least two times.
std::optional<FrameRate> RateOfTimes(const std::vector<double>& times);

// The fraction that is meant by a step between two frames: exact where it is a plain fraction,
// else the nearest of 24, 30000/1001 and the like. None outside of 1/1000 to 10000 per second.
std::optional<FrameRate> RateOfStep(double seconds);

}  // namespace pleat
