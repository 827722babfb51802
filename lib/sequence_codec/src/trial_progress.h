// Progress of a search that does not know beforehand how often it will try, and of parts of a
// stage.
#pragma once

#include <algorithm>
#include <string>
#include <utility>

#include "pleat/base/progress.h"

namespace pleat {

// Returns the token of [begin, end] of the stage of `progress`, which must outlive it.
inline Progress PartOf(const Progress& progress, double begin, double end) {
  return Progress(
      [&progress, begin, end](const ProgressUpdate& update) {
        // Whoever reports next hears of a cancellation.
        progress.Report(begin + update.fraction * (end - begin), update.objective).IgnoreError();
      },
      [&progress] { return progress.cancelled(); });
}

class TrialProgress {
 public:
  explicit TrialProgress(Progress progress) : progress_(std::move(progress)) {}

  // Returns the token of the next trial. num_expected: how many trials are to come, this one
  // included, as far as one can tell. The trial gets that share of what is left, so the bar never
  // runs backwards and never stands at its end while trials go on.
  Progress Next(const std::string& stage, double num_expected) {
    const double begin = done_;
    done_ += (1 - done_) / std::max(kFewestExpected, num_expected);
    return progress_.Stage(stage, begin, done_);
  }

 private:
  // Not 1, since what looks like the last trial may not be it.
  static constexpr double kFewestExpected = 1.25;

  Progress progress_;
  double done_ = 0;
};

}  // namespace pleat
