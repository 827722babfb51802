#include "cli/batch/batch_run.h"

#include <algorithm>
#include <mutex>
#include <thread>

namespace pleat {
namespace {

constexpr double kFirstWaitSeconds = 1, kLongestWaitSeconds = 30;

class Batch {
 public:
  Batch(const std::vector<BatchTake>& takes, BatchReport* report, const BatchRules& rules,
        const BatchSteps& steps)
      : takes_(takes), report_(report), rules_(rules), steps_(steps) {}

  absl::StatusOr<BatchSummary> Run() {
    std::vector<std::thread> threads;
    const auto count = std::clamp<size_t>(static_cast<size_t>(rules_.in_flight), 1, takes_.size());
    for (size_t i = 0; i < count; ++i) threads.emplace_back([this] { Work(); });
    for (std::thread& thread : threads) thread.join();
    if (!fault_.ok()) return fault_;
    if (steps_.interrupted()) return absl::CancelledError("the batch was interrupted");
    return std::move(summary_);
  }

 private:
  void Work() {
    while (const BatchTake* take = Next()) {
      BatchRow row{.name = take->name,
                   .inputs = take->inputs,
                   .fingerprint = steps_.fingerprint(*take),
                   .status = absl::OkStatus()};
      if (report_->IsDone(row.name, row.fingerprint)) {
        std::lock_guard lock(mutex_);
        ++summary_.num_skipped;
        continue;
      }
      const double start = steps_.clock_seconds();
      Try(*take, &row);
      row.seconds = steps_.clock_seconds() - start;
      if (steps_.interrupted()) return;
      End(row);
    }
  }

  // The next take of the list; null when there is none, or when the batch ends early.
  const BatchTake* Next() {
    std::lock_guard lock(mutex_);
    if (next_ == takes_.size() || !fault_.ok() || steps_.interrupted()) return nullptr;
    return &takes_[next_++];
  }

  void Try(const BatchTake& take, BatchRow* row) {
    const int attempt = report_->NumFailures(row->name, row->fingerprint);
    const double end = steps_.clock_seconds() + rules_.patience_seconds;
    for (double pause = kFirstWaitSeconds;; pause = std::min(2 * pause, kLongestWaitSeconds)) {
      row->status = absl::OkStatus();
      steps_.work(take, attempt, row);
      if (!absl::IsUnavailable(row->status) || steps_.clock_seconds() + pause > end) return;
      if (!steps_.wait(pause)) return;
    }
  }

  void End(const BatchRow& row) {
    const absl::Status written = report_->Add(row);
    std::lock_guard lock(mutex_);
    if (fault_.ok()) fault_ = written;
    summary_.rows.push_back(row);
    steps_.tell(row, summary_.rows.size() + summary_.num_skipped, takes_.size());
  }

  const std::vector<BatchTake>& takes_;
  BatchReport* const report_;
  const BatchRules& rules_;
  const BatchSteps& steps_;
  std::mutex mutex_;  // guards all below
  size_t next_ = 0;
  absl::Status fault_;  // of the report
  BatchSummary summary_;
};

}  // namespace

absl::StatusOr<BatchSummary> RunBatch(const std::vector<BatchTake>& takes, BatchReport* report,
                                      const BatchRules& rules, const BatchSteps& steps) {
  return Batch(takes, report, rules, steps).Run();
}

}  // namespace pleat
