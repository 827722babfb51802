#include "pleat/base/progress.h"

#include <algorithm>
#include <memory>
#include <utility>

namespace pleat {

Progress::Progress(Sink sink, CancelTest cancel_test)
    : sink_(std::move(sink)), cancel_test_(std::move(cancel_test)) {}

absl::Status Progress::Report(double fraction, std::optional<double> objective) const {
  if (cancelled()) return absl::CancelledError("the computation was cancelled by its caller");
  if (sink_) {
    const double clamped = std::clamp(fraction, 0.0, 1.0);
    sink_({stage_, begin_ + clamped * (end_ - begin_), objective});
  }
  return absl::OkStatus();
}

Progress Progress::Stage(const std::string& stage, double begin, double end) const {
  Progress sub = *this;
  sub.stage_ = stage;
  sub.begin_ = begin_ + begin * (end_ - begin_);
  sub.end_ = begin_ + end * (end_ - begin_);
  return sub;
}

Progress Progress::ForwardOnly() const {
  // The fraction is shared, because every stage of the token has a copy of the sink.
  return Progress(
      [whole = *this, furthest = std::make_shared<double>(0)](const ProgressUpdate& update) {
        *furthest = std::max(*furthest, update.fraction);
        // Whoever reports next hears of a cancellation.
        whole.Stage(update.stage, 0, 1).Report(*furthest, update.objective).IgnoreError();
      },
      cancel_test_);
}

bool Progress::cancelled() const { return cancel_test_ && cancel_test_(); }

}  // namespace pleat
