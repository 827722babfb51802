#include "cli/show/progress_display.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "cli/interrupt.h"
#include "cli/session.h"

namespace pleat {
namespace {

constexpr int kBarCells = 24;
constexpr int kStageColumns = 10;
constexpr int kTerminalColumns = 79;
constexpr double kRedrawSeconds = 0.1;
constexpr double kLineSeconds = 5;
constexpr double kNewStageSeconds = 1;  // stages that last for a moment would only fill the log
constexpr double kQuietSeconds = 0.5;   // work that is done by then shows no progress
constexpr double kMaxSeconds = 1e9;     // of a duration; a server may say anything

std::string TimeText(double fraction, double elapsed_seconds, std::optional<double> eta_seconds) {
  // An extrapolation from the first moments would only jump around.
  if (!eta_seconds && fraction > 0.03 && fraction < 1 && elapsed_seconds > 2) {
    eta_seconds = elapsed_seconds * (1 - fraction) / fraction;
  }
  std::string text = FormatDuration(elapsed_seconds);
  if (eta_seconds && fraction < 1)
    absl::StrAppend(&text, ", ", FormatDuration(*eta_seconds), " left");
  return text;
}

int Percent(double fraction) {
  if (std::isnan(fraction)) return 0;
  return static_cast<int>(std::floor(100 * std::clamp(fraction, 0.0, 1.0) + 1e-9));
}

}  // namespace

std::string FormatDuration(double seconds) {
  const long whole = std::isnan(seconds) ? 0 : std::lround(std::clamp(seconds, 0.0, kMaxSeconds));
  if (whole < 60) return absl::StrCat(whole, " s");
  if (whole < 3600) return absl::StrCat(whole / 60, " min ", whole % 60, " s");
  return absl::StrCat(whole / 3600, " h ", whole / 60 % 60, " min");
}

std::string FormatProgressBar(const ProgressUpdate& update, double elapsed_seconds,
                              std::optional<double> eta_seconds, int width) {
  const int filled = Percent(update.fraction) * kBarCells / 100;
  std::string line = absl::StrFormat("%-*s [%s%s] %3d %%  %s", kStageColumns, update.stage,
                                     std::string(filled, '#'), std::string(kBarCells - filled, '-'),
                                     Percent(update.fraction),
                                     TimeText(update.fraction, elapsed_seconds, eta_seconds));
  if (update.objective) absl::StrAppendFormat(&line, ", objective %.6g", *update.objective);
  if (static_cast<int>(line.size()) > width) line.resize(std::max(width, 0));
  return line;
}

std::string FormatProgressLine(const ProgressUpdate& update, double elapsed_seconds,
                               std::optional<double> eta_seconds) {
  std::string line = absl::StrFormat(
      "%s: %d %%, %s", update.stage.empty() ? "running" : update.stage, Percent(update.fraction),
      TimeText(update.fraction, elapsed_seconds, eta_seconds));
  if (update.objective) absl::StrAppendFormat(&line, ", objective %.6g", *update.objective);
  return line;
}

ProgressDisplay::ProgressDisplay(std::ostream& out, ProgressStyle style,
                                 std::function<double()> clock_seconds)
    : out_(out),
      style_(style),
      clock_seconds_(std::move(clock_seconds)),
      start_seconds_(clock_seconds_()),
      stage_start_seconds_(start_seconds_),
      last_drawn_seconds_(-1e9) {}

bool ProgressDisplay::Due(const ProgressUpdate& update, double now) const {
  if (style_ == ProgressStyle::kSilent || now - start_seconds_ < kQuietSeconds) return false;
  const double waited = now - last_drawn_seconds_;
  if (style_ == ProgressStyle::kBar) return waited >= kRedrawSeconds || update.fraction >= 1;
  return waited >= (stage_ == drawn_stage_ ? kLineSeconds : kNewStageSeconds);
}

void ProgressDisplay::Update(const ProgressUpdate& update, std::optional<double> eta_seconds) {
  std::lock_guard lock(mutex_);
  const double now = clock_seconds_();
  // A job that starts again, or a fraction that is no number, leaves the bar where it is.
  if (update.fraction > fraction_) fraction_ = std::min(update.fraction, 1.0);
  const bool new_stage = update.stage != stage_;
  if (new_stage) {
    if (!stage_.empty()) stage_seconds_[stage_] += now - stage_start_seconds_;
    stage_ = update.stage;
    stage_start_seconds_ = now;
  }
  const ProgressUpdate shown{update.stage, fraction_, update.objective};
  if (!Due(shown, now)) return;
  last_drawn_seconds_ = now;
  drawn_stage_ = stage_;
  if (style_ == ProgressStyle::kBar) {
    out_ << '\r' << FormatProgressBar(shown, now - start_seconds_, eta_seconds, kTerminalColumns)
         << "\x1b[K" << std::flush;
    line_open_ = true;
  } else {
    out_ << FormatProgressLine(shown, now - start_seconds_, eta_seconds) << std::endl;
  }
}

void ProgressDisplay::Finish() {
  std::lock_guard lock(mutex_);
  if (!stage_.empty()) stage_seconds_[stage_] += clock_seconds_() - stage_start_seconds_;
  stage_.clear();
  if (line_open_) out_ << std::endl;
  line_open_ = false;
}

std::map<std::string, double> ProgressDisplay::stage_seconds() const {
  std::lock_guard lock(mutex_);
  return stage_seconds_;
}

ProgressStyle ChooseProgressStyle(const Session& session) {
  if (!session.talkative()) return ProgressStyle::kSilent;
  return session.err_is_terminal ? ProgressStyle::kBar : ProgressStyle::kLines;
}

Progress InterruptibleProgress(ProgressDisplay* display) {
  return Progress([display](const ProgressUpdate& update) { display->Update(update); },
                  [] { return Interrupted(); });
}

}  // namespace pleat
