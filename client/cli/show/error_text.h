// Error summaries as table rows.
#pragma once

#include <string>
#include <vector>

#include "pleat/character/character_model.h"
#include "pleat/mesh/error_metrics.h"

namespace pleat {

// `first` and the columns mean, rms, p95, max in percent, mean and max in millimeters.
std::vector<std::string> ErrorTableHeader(const std::string& first);

// diagonal_m: what the percents are of, meters.
std::vector<std::string> ErrorTableRow(const std::string& name, const ErrorSummary& error,
                                       double diagonal_m);

// A line that says by what a learner was chosen; empty when nothing was held out.
std::string ValidationText(const LearnerValidation& validation);

// Errors in percent with how the motion looks: the mean error of frame-to-frame steps (mm and %)
// and the jitter (RMS second difference, mm); "-" where no frames follow each other.
std::vector<std::string> MotionTableHeader(const std::string& first);
std::vector<std::string> MotionTableRow(const std::string& name, const ErrorSummary& error);

}  // namespace pleat
