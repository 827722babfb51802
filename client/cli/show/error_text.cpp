#include "cli/show/error_text.h"

#include "absl/strings/str_format.h"

namespace pleat {

std::vector<std::string> ErrorTableHeader(const std::string& first) {
  return {first, "mean %", "rms %", "p95 %", "max %", "mean mm", "max mm"};
}

std::vector<std::string> ErrorTableRow(const std::string& name, const ErrorSummary& error,
                                       double diagonal_m) {
  return {name,
          absl::StrFormat("%.3f", error.mean_percent),
          absl::StrFormat("%.3f", error.rms_percent),
          absl::StrFormat("%.3f", error.p95_percent),
          absl::StrFormat("%.2f", error.max_percent),
          absl::StrFormat("%.2f", error.mean_mm),
          absl::StrFormat("%.1f", error.max_percent / 100 * diagonal_m * 1000)};
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
  return {first, "mean %", "rms %", "p95 %", "max %", "mean mm", "step %", "step mm", "jitter mm"};
}

std::vector<std::string> MotionTableRow(const std::string& name, const ErrorSummary& error) {
  const auto measured = [](int count, double value, int digits) {
    return count > 0 ? absl::StrFormat("%.*f", digits, value) : std::string("-");
  };
  return {name,
          absl::StrFormat("%.3f", error.mean_percent),
          absl::StrFormat("%.3f", error.rms_percent),
          absl::StrFormat("%.3f", error.p95_percent),
          absl::StrFormat("%.2f", error.max_percent),
          absl::StrFormat("%.2f", error.mean_mm),
          measured(error.num_motion_frames, error.motion_mean_percent, 3),
          measured(error.num_motion_frames, error.motion_mean_mm, 2),
          measured(error.num_jitter_frames, error.jitter_mm, 2)};
}

}  // namespace pleat
