#include "cli/batch/batch_run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <latch>
#include <set>

#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

std::vector<BatchTake> MakeTakes(int count) {
  std::vector<BatchTake> takes;
  for (int i = 0; i < count; ++i) {
    takes.push_back({.name = "take" + std::to_string(i), .inputs = {"x"}, .line = i + 1});
  }
  return takes;
}

class BatchRunTest : public testing::Test {
 protected:
  BatchRunTest() {
    steps_ = {.fingerprint = [](const BatchTake&) { return std::string("f"); },
              .work = [](const BatchTake&, int, BatchRow* row) { row->result_id = "r"; },
              .wait =
                  [this](double seconds) {
                    std::lock_guard lock(mutex_);
                    now_ += seconds;
                    waits_.push_back(seconds);
                    return !interrupted_;
                  },
              .interrupted = [this] { return interrupted_.load(); },
              .clock_seconds =
                  [this] {
                    std::lock_guard lock(mutex_);
                    return now_;
                  },
              .tell = [this](const BatchRow& row, size_t, size_t) { told_.push_back(row.name); }};
  }
  absl::StatusOr<BatchSummary> Run(const std::vector<BatchTake>& takes, int in_flight = 1) {
    const auto report = BatchReport::Open(folder_.File("report.jsonl")).value();
    return RunBatch(takes, report.get(), {.in_flight = in_flight, .patience_seconds = 100}, steps_);
  }

  const TemporaryFolder folder_;
  BatchSteps steps_;
  std::mutex mutex_;
  double now_ = 0;
  std::vector<double> waits_;
  std::vector<std::string> told_;
  std::atomic<bool> interrupted_ = false;
};

TEST_F(BatchRunTest, TakesAreDoneInTheirOrderAndNotTwice) {
  const BatchSummary first = Run(MakeTakes(3)).value();
  EXPECT_THAT(told_, testing::ElementsAre("take0", "take1", "take2"));
  EXPECT_EQ(first.rows.size(), 3u);
  const BatchSummary second = Run(MakeTakes(4)).value();
  EXPECT_EQ(second.num_skipped, 3u);
  ASSERT_EQ(second.rows.size(), 1u);
  EXPECT_EQ(second.rows[0].name, "take3");
}

TEST_F(BatchRunTest, AFailureStopsNobodyAndIsTriedAgainByTheNextRun) {
  std::vector<int> attempts;
  steps_.work = [&](const BatchTake& take, int attempt, BatchRow* row) {
    if (take.name != "take1") return;
    attempts.push_back(attempt);
    row->status = absl::FailedPreconditionError("no rig");
  };
  EXPECT_EQ(Run(MakeTakes(3)).value().rows.size(), 3u);
  EXPECT_EQ(Run(MakeTakes(3)).value().rows.size(), 1u);
  EXPECT_THAT(attempts, testing::ElementsAre(0, 1));
}

TEST_F(BatchRunTest, AServerThatIsAwayIsWaitedForLongerAndLonger) {
  int num_calls = 0;
  steps_.work = [&](const BatchTake&, int, BatchRow* row) {
    if (++num_calls < 5) row->status = absl::UnavailableError("no answer");
  };
  EXPECT_TRUE(Run(MakeTakes(1)).value().rows[0].status.ok());
  EXPECT_THAT(waits_, testing::ElementsAre(1, 2, 4, 8));
}

TEST_F(BatchRunTest, PatienceEnds) {
  steps_.work = [&](const BatchTake&, int, BatchRow* row) {
    row->status = absl::UnavailableError("no answer");
  };
  const BatchSummary summary = Run(MakeTakes(1)).value();
  EXPECT_TRUE(absl::IsUnavailable(summary.rows[0].status));
  EXPECT_LE(now_, 100);
  EXPECT_GT(now_, 50);
}

TEST_F(BatchRunTest, SeveralAreUnderWayAtOnce) {
  std::latch all_began(3);
  std::mutex mutex;
  std::set<std::string> names;
  steps_.work = [&](const BatchTake& take, int, BatchRow*) {
    all_began.arrive_and_wait();  // hangs unless three are at work
    std::lock_guard lock(mutex);
    names.insert(take.name);
  };
  EXPECT_EQ(Run(MakeTakes(3), 3).value().rows.size(), 3u);
  EXPECT_EQ(names.size(), 3u);
}

TEST_F(BatchRunTest, AnInterruptedTakeHasNoRow) {
  steps_.work = [&](const BatchTake& take, int, BatchRow* row) {
    if (take.name != "take1") return;
    interrupted_ = true;
    row->status = absl::CancelledError("interrupted");
  };
  EXPECT_THAT(Run(MakeTakes(3)), HasStatus(absl::StatusCode::kCancelled, testing::_));
  interrupted_ = false;
  steps_.work = [](const BatchTake&, int, BatchRow*) {};
  const BatchSummary rest = Run(MakeTakes(3)).value();
  EXPECT_EQ(rest.num_skipped, 1u);
  EXPECT_EQ(rest.rows.size(), 2u);
}

}  // namespace
}  // namespace pleat
