// Error summaries as table rows.
#pragma once

#include <string>
#include <vector>

#include "pleat/mesh/error_metrics.h"

namespace pleat {

// `first` and the columns mean, rms, p95, max in percent, mean and max in millimetres.
std::vector<std::string> ErrorTableHeader(const std::string& first);

// diagonal_m: what the percents are of, metres.
std::vector<std::string> ErrorTableRow(const std::string& name, const ErrorSummary& error,
                                       double diagonal_m);

}  // namespace pleat
