// Sequences of a point cache and the mesh beside it.
#include <cmath>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "frame_times.h"
#include "mesh_beside.h"
#include "pleat/base/status.h"
#include "pleat/formats/mdd.h"
#include "pleat/formats/pc2.h"

namespace pleat {
namespace {

InputNote TimeWarning(const char* kind, std::string text) {
  return {.severity = NoteSeverity::kWarning, .kind = kind, .text = std::move(text)};
}

// Start and rate are frames of the host's timeline, which the file does not say the rate of.
void CheckTimes(const std::string& cache_name, const PointCache& cache, FrameRate used,
                InputReport* report) {
  const bool is_bad = !std::isfinite(cache.start_frame) || !std::isfinite(cache.sample_rate) ||
                      !(cache.sample_rate > 0);
  if (is_bad) {
    report->notes.push_back(TimeWarning(
        "times_invalid",
        absl::StrFormat("%s: the header says start %g and %g frames per sample, which is no "
                        "time; %g samples per second are taken, say --fps for another rate",
                        cache_name, cache.start_frame, cache.sample_rate, used.fps())));
    return;
  }
  report->first_frame = cache.start_frame;
  if (cache.start_frame != 0 || cache.sample_rate != 1) {
    report->notes.push_back(
        {.kind = "times_ignored",
         .text = absl::StrFormat("%s: start %g and %g frames per sample are ignored: frames count "
                                 "from 0, %g per second; say --fps for another rate",
                                 cache_name, cache.start_frame, cache.sample_rate, used.fps())});
  }
}

// The frame rate of an MDD, which it does not hold but its times have.
FrameRate RateOfMdd(const std::string& cache_name, const MddCache& cache,
                    const InputReading& reading) {
  const std::optional<FrameRate> rate = RateOfFloatTimes(cache.times_s);
  const FrameRate used = reading.options.frame_rate.value_or(rate.value_or(FrameRate{}));
  InputReport* report = reading.report;
  report->has_frame_rate = rate.has_value();
  if (std::isfinite(cache.times_s[0])) {
    report->first_frame = FrameNumberAt(cache.times_s[0], used);
  }
  if (rate && cache.times_s[0] != 0) {
    report->notes.push_back(
        {.kind = "times_ignored",
         .text = absl::StrFormat("%s: the first frame is at %g s (number %g of its timeline); here "
                                 "frames count from 0",
                                 cache_name, cache.times_s[0], *report->first_frame)});
  }
  if (!rate && cache.frames.size() > 1 && !reading.options.frame_rate) {
    report->notes.push_back(TimeWarning(
        "frame_rate_assumed",
        absl::StrFormat(
            "%s: its times are not evenly spaced (%g s, %g s, ...); each is a frame, at "
            "%g per second; say --fps for another rate",
            cache_name, cache.times_s[0], cache.times_s[1], used.fps())));
  }
  return used;
}

}  // namespace

absl::StatusOr<MeshSequence> ReadPointCacheSequence(const std::string& path,
                                                    const InputReading& reading) {
  PLEAT_ASSIGN_OR_RETURN(PointCache cache, ReadPointCache(path, reading.options.limits));
  const FrameRate rate = reading.options.frame_rate.value_or(FrameRate{});
  CheckTimes(DisplayName(path), cache, rate, reading.report);
  return WithMeshBeside(path, std::move(cache.frames), rate, reading);
}

absl::StatusOr<MeshSequence> ReadMddSequence(const std::string& path, const InputReading& reading) {
  PLEAT_ASSIGN_OR_RETURN(MddCache cache, ReadMdd(path, reading.options.limits));
  const FrameRate rate = RateOfMdd(DisplayName(path), cache, reading);
  return WithMeshBeside(path, std::move(cache.frames), rate, reading);
}

}  // namespace pleat
