// Jobs of several projects in one manager.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <map>
#include <mutex>
#include <string>
#include <thread>

#include "jobs/scripted_work.h"
#include "pleat/base/limit_refusal.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

TEST(JobProjectsTest, OneProjectCannotHaveAllPlacesOfTheQueue) {
  Journal journal;
  JobManager jobs({.max_queued_per_project = 1}, Succeeds(), &journal);
  const auto create = [&](const std::string& project) {
    JobInfo draft = Named("job");
    draft.project = project;
    return jobs.Create(draft).status();
  };
  EXPECT_THAT(create("robots"), IsOk());
  const absl::Status refused = create("robots");
  EXPECT_THAT(refused,
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("'robots' has 1")));
  EXPECT_EQ(LimitRefusalOf(refused)->subject, "project:robots");
  EXPECT_THAT(create("ghosts"), IsOk());
}

TEST(JobProjectsTest, RequestIdsAreThoseOfAProject) {
  Journal journal;
  JobManager jobs({}, Succeeds(), &journal);
  JobInfo draft = Named("job");
  draft.request_id = "the same";
  draft.project = "robots";
  PLEAT_ASSERT_OK_AND_ASSIGN(const JobInfo first, jobs.Create(draft));
  EXPECT_EQ(jobs.Create(draft)->id, first.id);
  draft.project = "ghosts";
  draft.sequence_ids = {"something else"};
  PLEAT_ASSERT_OK_AND_ASSIGN(const JobInfo other, jobs.Create(draft));
  EXPECT_NE(other.id, first.id);
}

TEST(JobProjectsTest, AJobIsThatOfItsProjectAlone) {
  Journal journal;
  JobManager jobs({}, Succeeds(), &journal);
  JobInfo draft = Named("x");
  draft.project = "robots";
  const std::string id = jobs.Create(draft)->id;
  for (const bool has_ended : {false, true}) {
    EXPECT_EQ(jobs.Get(id, "robots")->name, "x");
    EXPECT_THAT(jobs.Get(id, "ghosts"), HasStatus(absl::StatusCode::kNotFound, HasSubstr(id)));
    EXPECT_THAT(jobs.Cancel(id), HasStatus(absl::StatusCode::kNotFound, HasSubstr(id)));
    EXPECT_THAT(jobs.Delete(id), HasStatus(absl::StatusCode::kNotFound, HasSubstr(id)));
    if (!has_ended) {
      EXPECT_THAT(jobs.Cancel(id, "robots"), IsOk());
    }
  }
  EXPECT_THAT(jobs.Delete(id, "robots"), IsOk());
}

TEST(JobProjectsTest, TellsTheProcessorTimeOfEachProject) {
  Journal journal;
  std::mutex mutex;
  std::map<std::string, double> used;  // by project; guarded by mutex
  JobManager jobs(
      {.on_processor_time =
           [&](const std::string& project, double seconds) {
             EXPECT_GT(seconds, 0);
             std::lock_guard lock(mutex);
             used[project] += seconds;
           }},
      [&](const JobInfo& info, const Progress& progress) {
        // Until so much was told that it can only be this work.
        for (double told = 0; info.name == "works" && told < .02;) {
          progress.Report(.5).IgnoreError();
          std::lock_guard lock(mutex);
          told = used[info.project];
        }
        return Succeeds()(info, progress);
      },
      &journal);
  JobInfo works = Named("works"), rests = Named("rests");
  works.project = "robots";
  rests.project = "ghosts";
  const std::string first = jobs.Create(works)->id, second = jobs.Create(rests)->id;
  jobs.Start();
  while (!IsFinal(jobs.Get(second, "ghosts")->state)) std::this_thread::yield();
  EXPECT_EQ(jobs.Get(first, "robots")->state, JobState::kSucceeded);
  jobs.Shutdown();
  EXPECT_GE(used["robots"], .02);
  EXPECT_LT(used["ghosts"], used["robots"]);
}

TEST(JobProjectsTest, AProjectThatHasUsedUpItsTimeWaitsAndTheOthersGoOn) {
  Journal journal;
  std::atomic<bool> waits = true;
  JobManager jobs({.waiting_time =
                       [&](const std::string& project) {
                         return waits && project == "robots" ? absl::Milliseconds(1)
                                                             : absl::ZeroDuration();
                       }},
                  Succeeds(), &journal);
  JobInfo robot = Named("robot"), ghost = Named("ghost");
  robot.project = "robots";
  ghost.project = "ghosts";
  const std::string first = jobs.Create(robot)->id, second = jobs.Create(ghost)->id;
  jobs.Start();
  while (!IsFinal(jobs.Get(second, "ghosts")->state)) std::this_thread::yield();
  EXPECT_EQ(jobs.Get(first, "robots")->state, JobState::kQueued);
  waits = false;  // and nobody says so: the manager looks again by itself
  while (!IsFinal(jobs.Get(first, "robots")->state)) std::this_thread::yield();
  EXPECT_EQ(jobs.Get(first, "robots")->state, JobState::kSucceeded);
}

}  // namespace
}  // namespace pleat
