// Progress and cooperative cancellation of a long computation, in one token.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "absl/status/status.h"

namespace pleat {

// One report of where a computation stands.
struct ProgressUpdate {
  std::string stage;                // e.g. "rig", "fit", "learn"
  double fraction = 0;              // share of the whole computation, 0..1
  std::optional<double> objective;  // value of the running optimizer, if any
};

// A token that is handed down by value to everything that may run longer than a second. The default
// token reports to nobody and is never cancelled. Copies share the sink and the cancellation test.
// The sink is called from the thread that computes and need not be safe for several threads:
// parallel loops report between their batches. The cancellation test is called from any thread.
class Progress {
 public:
  using Sink = std::function<void(const ProgressUpdate&)>;
  using CancelTest = std::function<bool()>;

  Progress() = default;
  Progress(Sink sink, CancelTest cancel_test);

  // Reports that `fraction` (0..1) of this token's range is done. Returns kCancelled, without a
  // report, when the caller asked to stop: pass that status on at once.
  absl::Status Report(double fraction, std::optional<double> objective = std::nullopt) const;

  // Returns the token of a sub-step named `stage` that covers [begin, end] of this token's range.
  Progress Stage(const std::string& stage, double begin, double end) const;

  // Returns a token that passes on to this one what it hears, but never a smaller fraction than it
  // heard before: for a step that may be given up and repeated in another way.
  Progress ForwardOnly() const;

  // Returns true when the caller asked to stop. It is cheap; call it at least every 100 ms of work.
  bool cancelled() const;

 private:
  Sink sink_;
  CancelTest cancel_test_;
  std::string stage_;
  double begin_ = 0, end_ = 1;  // this token's range in the whole computation
};

}  // namespace pleat
