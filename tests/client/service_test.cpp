#include "cli/service.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <sstream>

#include "cli/exit_code.h"
#include "support/mock_services.h"
#include "support/scripted_jobs.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

JobInfo Job(JobState state, const std::string& stage = "", double fraction = 0) {
  JobInfo job;
  job.id = "j1";
  job.state = state;
  job.stage = stage;
  job.fraction = fraction;
  return job;
}

absl::StatusOr<JobInfo> Watch(std::vector<JobInfo> script,
                              std::map<std::string, double>* seconds = nullptr) {
  std::ostringstream out, err;
  Session session;
  session.out = &out;
  session.err = &err;
  testing::NiceMock<MockJobService> jobs;
  ON_CALL(jobs, Subscribe("j1", testing::_))
      .WillByDefault([&](const std::string&, std::function<void()> listener) {
        return std::make_unique<ScriptedSubscription>(
            script, absl::UnavailableError("the connection broke"), std::move(listener));
      });
  return WatchJobToEnd(jobs, "j1", session, true, seconds);
}

TEST(Service, CompletesIdsFromTheirFirstDigits) {
  testing::NiceMock<MockModelService> models;
  std::vector<ModelInfo> infos(2);
  infos[0].id = "abc1";
  infos[1].id = "abd2";
  ON_CALL(models, ListPage).WillByDefault(testing::Return(Page<ModelInfo>{infos, ""}));
  EXPECT_EQ(FindModel(models, "abc").value_or(""), "abc1");
  EXPECT_EQ(FindModel(models, "abd2").value_or(""), "abd2");
  EXPECT_TRUE(IsUsageError(FindModel(models, "ab").status()));
  EXPECT_THAT(FindModel(models, "x"),
              HasStatus(absl::StatusCode::kNotFound, HasSubstr("no model x")));
  EXPECT_EQ(FindModel(models, "").status().code(), absl::StatusCode::kNotFound);
}

TEST(Service, WatchingEndsWithTheModel) {
  JobInfo done = Job(JobState::kSucceeded, "", 1);
  done.result_id = "m1";
  std::map<std::string, double> seconds;
  PLEAT_ASSERT_OK_AND_ASSIGN(const JobInfo job,
                             Watch({Job(JobState::kQueued), Job(JobState::kRunning, "rig", .1),
                                    Job(JobState::kRunning, "fit", .5), done},
                                   &seconds));
  EXPECT_EQ(job.result_id, "m1");
  EXPECT_EQ(seconds.count("rig"), 1u);
  EXPECT_EQ(seconds.count("fit"), 1u);
}

TEST(Service, AFailedJobGivesItsOwnErrorAndExitCode) {
  JobInfo failed = Job(JobState::kFailed);
  failed.error = absl::FailedPreconditionError("no human-like rig");
  const absl::Status status = Watch({Job(JobState::kRunning, "rig", .1), failed}).status();
  EXPECT_THAT(status, HasStatus(absl::StatusCode::kFailedPrecondition,
                                HasSubstr("job j1 failed: no human-like rig")));
  EXPECT_EQ(ExitCodeOf(status), ExitCode::kRefused);
  EXPECT_EQ(ExitCodeOf(Watch({Job(JobState::kCancelled)}).status()), ExitCode::kCancelled);
}

TEST(Service, AWatchThatBreaksOffIsNotASuccess) {
  const absl::Status status = Watch({Job(JobState::kRunning, "rig", .1)}).status();
  EXPECT_EQ(ExitCodeOf(status), ExitCode::kUnavailable);
  EXPECT_THAT(std::string(status.message()), HasSubstr("the connection broke"));
  EXPECT_THAT(std::string(status.message()), HasSubstr("pleat jobs show j1"));
}

}  // namespace
}  // namespace pleat
