// Shows progress on a terminal, as one line that is redrawn, or in a log, as a few plain lines.
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

// Returns "fit   [############------------]  50 %  12 s, 12 s left", in at most `width` columns.
std::string FormatProgressBar(const ProgressUpdate& update, double elapsed_seconds,
                              std::optional<double> eta_seconds, int width);
// Returns "fit: 50 %, 12 s, 12 s left".
std::string FormatProgressLine(const ProgressUpdate& update, double elapsed_seconds,
                               std::optional<double> eta_seconds);
// Returns "8 s", "3 min 20 s" or "2 h 5 min".
std::string FormatDuration(double seconds);

enum class ProgressStyle { kSilent, kLines, kBar };

// Draws updates and adds up the seconds that each stage took. What it draws never runs backwards.
// Thread-safe.
class ProgressDisplay {
 public:
  ProgressDisplay(std::ostream& out, ProgressStyle style, std::function<double()> clock_seconds);
  ~ProgressDisplay() { Finish(); }

  // eta_seconds: the time that is left, when somebody else knows it; otherwise it is extrapolated.
  void Update(const ProgressUpdate& update, std::optional<double> eta_seconds = std::nullopt);
  // Ends the line of the bar and the running stage. It may be called twice.
  void Finish();

  // Returns, by the name of a stage, the seconds from its first update to that of the next stage.
  std::map<std::string, double> stage_seconds() const;

 private:
  // Says whether this update is to be drawn. Call it with mutex_ held.
  bool Due(const ProgressUpdate& update, double now) const;

  std::ostream& out_;
  const ProgressStyle style_;
  const std::function<double()> clock_seconds_;

  mutable std::mutex mutex_;  // guards everything below
  const double start_seconds_;
  double stage_start_seconds_;
  double last_drawn_seconds_;
  std::string stage_, drawn_stage_;
  std::map<std::string, double> stage_seconds_;
  double fraction_ = 0;  // the largest so far
  bool line_open_ = false;
};

// Returns a bar, lines or nothing, as the flags and the terminal of the session say.
ProgressStyle ChooseProgressStyle(const Session& session);

// Returns a token that draws on `display` and is cancelled by Ctrl-C. `display` must outlive it.
Progress InterruptibleProgress(ProgressDisplay* display);

}  // namespace pleat
