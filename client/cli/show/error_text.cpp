#include "cli/show/error_text.h"

#include "absl/strings/str_format.h"

namespace pleat {
namespace {

// The columns that both tables begin with, and those that `more` adds.
std::vector<std::string> HeaderWith(const std::string& first,
                                    const std::vector<std::string>& more) {
  std::vector<std::string> header = {first, "mean %", "rms %", "p95 %", "max %", "mean mm"};
  header.insert(header.end(), more.begin(), more.end());
  return header;
}

std::vector<std::string> RowWith(const std::string& name, const ErrorSummary& error,
                                 const std::vector<std::string>& more) {
  std::vector<std::string> row = {name,
                                  absl::StrFormat("%.3f", error.mean_percent),
                                  absl::StrFormat("%.3f", error.rms_percent),
                                  absl::StrFormat("%.3f", error.p95_percent),
                                  absl::StrFormat("%.2f", error.max_percent),
                                  absl::StrFormat("%.2f", error.mean_mm)};
  row.insert(row.end(), more.begin(), more.end());
  return row;
}

}  // namespace

std::vector<std::string> ErrorTableHeader(const std::string& first) {
  return HeaderWith(first, {"max mm"});
}

std::vector<std::string> ErrorTableRow(const std::string& name, const ErrorSummary& error,
                                       double diagonal_m) {
  const double max_mm = error.max_percent / 100 * diagonal_m * 1000;
  return RowWith(name, error, {absl::StrFormat("%.1f", max_mm)});
}

std::string ValidationText(const LearnerValidation& validation) {
  if (validation.num_held_out_frames == 0) return "";
  std::string text = absl::StrFormat("learner chosen on %d training frames that none of them saw:",
                                     validation.num_held_out_frames);
  for (const auto& [learner, percent] : validation.mean_percent) {
    absl::StrAppendFormat(&text, " %s %.3f %%", learner, percent);
  }
  return text + "\n";
}

std::vector<std::string> MotionTableHeader(const std::string& first) {
  return HeaderWith(first, {"step %", "step mm", "jitter mm"});
}

std::vector<std::string> MotionTableRow(const std::string& name, const ErrorSummary& error) {
  const auto measured = [](int count, double value, int digits) {
    return count > 0 ? absl::StrFormat("%.*f", digits, value) : std::string("-");
  };
  return RowWith(name, error,
                 {measured(error.num_motion_frames, error.motion_mean_percent, 3),
                  measured(error.num_motion_frames, error.motion_mean_mm, 2),
                  measured(error.num_jitter_frames, error.jitter_mm, 2)});
}

}  // namespace pleat
