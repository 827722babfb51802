// Progress on a terminal (one line that is redrawn) or in a log (plain lines, few of them).
#pragma once

#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <ostream>
#include <string>

#include "pleat/base/progress.h"

namespace pleat {

struct Session;

// "fit   [############------------]  50 %  12 s, 12 s left"; never longer than `width` columns.
std::string FormatProgressBar(const ProgressUpdate& update, double elapsed_seconds,
                              std::optional<double> eta_seconds, int width);
// "fit: 50 %, 12 s, 12 s left"
std::string FormatProgressLine(const ProgressUpdate& update, double elapsed_seconds,
                               std::optional<double> eta_seconds);
// "8 s", "3 min 20 s", "2 h 5 min"
std::string FormatDuration(double seconds);

enum class ProgressStyle { kSilent, kLines, kBar };

// Draws updates and adds up the seconds that each stage took. Thread-safe.
class ProgressDisplay {
 public:
  ProgressDisplay(std::ostream& out, ProgressStyle style, std::function<double()> clock_seconds);
  ~ProgressDisplay() { Finish(); }

  // eta_seconds: what is left, when somebody else knows it; else extrapolated.
  void Update(const ProgressUpdate& update, std::optional<double> eta_seconds = std::nullopt);
  // Ends the bar's line and the running stage. Harmless when called twice.
  void Finish();

  // Stage name -> seconds between its first update and the next stage's first.
  std::map<std::string, double> stage_seconds() const;

 private:
  bool Due(const ProgressUpdate& update, double now) const;  // needs mutex_

  std::ostream& out_;
  const ProgressStyle style_;
  const std::function<double()> clock_seconds_;

  mutable std::mutex mutex_;  // guards all below
  const double start_seconds_;
  double stage_start_seconds_;
  double last_drawn_seconds_;
  std::string stage_, drawn_stage_;
  std::map<std::string, double> stage_seconds_;
  bool line_open_ = false;
};

// Bar, lines or nothing, as the session's flags and terminal say.
ProgressStyle ChooseProgressStyle(const Session& session);

// A token that draws on `display` and is cancelled by Ctrl-C.
Progress InterruptibleProgress(ProgressDisplay* display);

}  // namespace pleat
