#include "cli/error_text.h"

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

}  // namespace pleat
