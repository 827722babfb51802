// Error summaries as table rows.
#pragma once

#include <string>
#include <vector>

#include "pleat/character/character_model.h"
#include "pleat/mesh/error_metrics.h"

namespace pleat {

// Returns `first` and the columns mean, rms, p95 and max in percent, and mean and max in
// millimeters.
std::vector<std::string> ErrorTableHeader(const std::string& first);

// diagonal_m: what the percentages refer to, meters.
std::vector<std::string> ErrorTableRow(const std::string& name, const ErrorSummary& error,
                                       double diagonal_m);

// Returns a line that says by what the learner was chosen. It is empty when nothing was held out.
std::string ValidationText(const LearnerValidation& validation);

// Return errors in percent together with how the motion looks: the mean error of the steps from
// frame to frame (mm and %), and the jitter (RMS second difference, mm). They are "-" where no
// frames follow each other.
std::vector<std::string> MotionTableHeader(const std::string& first);
std::vector<std::string> MotionTableRow(const std::string& name, const ErrorSummary& error);

}  // namespace pleat
