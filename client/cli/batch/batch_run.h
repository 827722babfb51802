// Works through the takes of a batch, several at a time.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "cli/batch/batch_list.h"
#include "cli/batch/batch_report.h"

namespace pleat {

struct BatchRules {
  int in_flight = 4;              // takes at the same time
  double patience_seconds = 600;  // how long a take waits for a server that cannot be reached
};

// What a batch asks of the world around it. Called from several threads.
struct BatchSteps {
  // Stands for the inputs of a take as they are now, and for the options.
  std::function<std::string(const BatchTake& take)> fingerprint{};
  // Does one take and fills the row but for its name, inputs, fingerprint and seconds. attempt: how
  // often it has failed before.
  std::function<void(const BatchTake& take, int attempt, BatchRow* row)> work{};
  // Waits so long; false when the batch is to end.
  std::function<bool(double seconds)> wait{};
  std::function<bool()> interrupted{};
  std::function<double()> clock_seconds{};
  // Hears of each row, one at a time.
  std::function<void(const BatchRow& row, size_t num_done, size_t num_takes)> tell{};
};

struct BatchSummary {
  std::vector<BatchRow> rows;  // of this run, in the order of their ends
  size_t num_skipped = 0;      // takes whose result was there
};

// Takes begin in the order of the list. Those that are done in the report are left out, those that
// failed are tried again. A take for which the server cannot be reached is tried again until the
// patience ends. kCancelled when it was interrupted: takes that were under way have no row then.
// The error of a report that cannot be written ends the batch too.
absl::StatusOr<BatchSummary> RunBatch(const std::vector<BatchTake>& takes, BatchReport* report,
                                      const BatchRules& rules, const BatchSteps& steps);

}  // namespace pleat
