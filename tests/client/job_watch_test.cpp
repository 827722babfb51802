// Verbs that wait for a job of a service, here the one in this process.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "client/tube_files.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

class JobWatchTest : public testing::Test {
 protected:
  const TubeFiles files_;
};

TEST_F(JobWatchTest, TheResultIsPrintedAndQuietPrintsNothingElse) {
  const Outcome outcome = files_.TrainInStore();
  ASSERT_EQ(outcome.code, ExitCode::kOk) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("learner ridge"));
  EXPECT_THAT(outcome.out, HasSubstr("\nmodel "));
  const Outcome quiet = files_.TrainInStore({"--quiet"});
  EXPECT_EQ(quiet.code, ExitCode::kOk);
  EXPECT_THAT(quiet.out, HasSubstr("\nmodel "));
  EXPECT_THAT(quiet.err, IsEmpty());
}

TEST_F(JobWatchTest, AJobThatFailsGivesItsOwnReasonAndExitCode) {
  // The tube is no human: without a rig of its own it is refused.
  const Outcome outcome = files_.RunInStore({"train", files_.sequence_path()});
  EXPECT_EQ(outcome.code, ExitCode::kRefused);
  EXPECT_THAT(outcome.err, HasSubstr("pleat train: job "));
  EXPECT_THAT(outcome.err, HasSubstr(" failed: "));
  EXPECT_THAT(outcome.out, IsEmpty());
}

TEST_F(JobWatchTest, WatchingAJobThatHasEndedPrintsItsResultAtOnce) {
  ASSERT_EQ(files_.TrainInStore({"--quiet"}).code, ExitCode::kOk);
  const auto jobs = nlohmann::json::parse(files_.RunInStore({"jobs", "list", "--json"}).out);
  ASSERT_EQ(jobs.size(), 1u);
  const std::string id = jobs[0]["id"], result = jobs[0]["result_id"];
  const Outcome watched = files_.RunInStore({"jobs", "watch", id});
  EXPECT_EQ(watched.code, ExitCode::kOk) << watched.err;
  EXPECT_EQ(watched.out, result + "\n");
  const Outcome json = files_.RunInStore({"jobs", "watch", id, "--json"});
  EXPECT_EQ(nlohmann::json::parse(json.out), jobs[0]);
  EXPECT_THAT(json.err, IsEmpty());
}

TEST_F(JobWatchTest, StagesOfTheJobAreTimedInTheReport) {
  const Outcome outcome = files_.TrainInStore({"--json"});
  ASSERT_EQ(outcome.code, ExitCode::kOk) << outcome.err;
  const auto seconds = nlohmann::json::parse(outcome.out)["seconds"];
  double sum = 0;
  for (const char* stage : {"rig", "fit", "learn", "read"}) {
    ASSERT_TRUE(seconds.contains(stage)) << stage;
    EXPECT_GE(seconds[stage].get<double>(), 0) << stage;
    sum += seconds[stage].get<double>();
  }
  EXPECT_LE(sum, seconds["total"].get<double>() + 1e-6);
}

}  // namespace
}  // namespace pleat
