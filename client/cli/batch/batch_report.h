// What became of the takes of a batch: a line of JSON for each attempt, in a file that a later run
// goes on with.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace pleat {

struct BatchRow {
  std::string name{};
  std::vector<std::string> inputs{};
  // Stands for the inputs as they were and for the options: another one is another attempt.
  std::string fingerprint{};
  absl::Status status{};                    // OK: the result is there
  std::vector<std::string> sequence_ids{};  // on the service, as far as it came
  std::string job_id{}, result_id{}, output{};
  int num_frames = 0, num_vertices = 0;  // of the first input
  double mean_error_mm = -1;             // of the result; below 0: not known
  double seconds = 0;
};

std::string FormatBatchRow(const BatchRow& row);                  // one line, without its end
absl::StatusOr<BatchRow> ParseBatchRow(const std::string& line);  // kDataLoss

// Thread-safe. A row is on the disk, or not there at all: a line that a crash has cut off is left
// out of what was read, and overwritten.
class BatchReport {
 public:
  // The rows of the file, when it exists. kDataLoss names a line that is no row.
  static absl::StatusOr<std::unique_ptr<BatchReport>> Open(const std::string& path);
  ~BatchReport();

  // Whether the take has its result from the same inputs and options.
  bool IsDone(const std::string& name, const std::string& fingerprint) const;
  // How often it has failed with them.
  int NumFailures(const std::string& name, const std::string& fingerprint) const;
  absl::Status Add(const BatchRow& row);

 private:
  explicit BatchReport(int descriptor) : descriptor_(descriptor) {}
  absl::Status Read(const std::string& path);

  struct Seen {
    bool done = false;
    int num_failures = 0;
  };
  void Note(const BatchRow& row);  // with the mutex held, or before anyone else has the report

  const int descriptor_;
  mutable std::mutex mutex_;          // guards what was seen and the end of the file
  std::map<std::string, Seen> seen_;  // by name and fingerprint
};

// A table of what went wrong, refusals of the input first, then the most frequent; empty when all
// is well. Messages that differ in numbers and names alone are one row.
std::string BatchErrorTable(const std::vector<BatchRow>& rows);

}  // namespace pleat
