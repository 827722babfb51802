#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "client/tube_files.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

TEST(JobsVerbTest, AnEmptyStoreHasNoJobs) {
  const TubeFiles files;
  EXPECT_EQ(files.RunInStore({"jobs", "--json"}).out, "[]\n");
  const Outcome table = files.RunInStore({"jobs"});
  EXPECT_EQ(table.code, ExitCode::kOk);
  EXPECT_THAT(table.out, HasSubstr("state"));
}

TEST(JobsVerbTest, JobsOfBothKindsAreListedAndShown) {
  const TubeFiles files;
  ASSERT_EQ(files.TrainInStore({"-q"}).code, ExitCode::kOk);
  ASSERT_EQ(files
                .RunInStore({"compress", files.sequence_path(), "-o", files.File("t.plt"), "--kg",
                             "1", "-q"})
                .code,
            ExitCode::kOk);
  const auto jobs = nlohmann::json::parse(files.RunInStore({"jobs", "--json"}).out);
  ASSERT_EQ(jobs.size(), 2u);
  std::vector<std::string> kinds;
  for (const auto& job : jobs) {
    kinds.push_back(job["kind"]);
    EXPECT_EQ(job["state"], "succeeded");
    EXPECT_EQ(job["name"], "tube");
    EXPECT_EQ(job["sequence_ids"].size(), 1u);
    EXPECT_EQ(job["result_id"].get<std::string>().size(), 64u);
    EXPECT_LE(job["created"].get<std::string>(), job["started"].get<std::string>());
    EXPECT_LE(job["started"].get<std::string>(), job["ended"].get<std::string>());
    const Outcome shown = files.RunInStore({"jobs", "show", job["id"].get<std::string>()});
    EXPECT_EQ(nlohmann::json::parse(shown.out), job);
  }
  EXPECT_THAT(kinds, testing::UnorderedElementsAre("training", "compression"));
  EXPECT_THAT(files.RunInStore({"jobs"}).out,
              testing::AllOf(HasSubstr("100 %"), HasSubstr("training"), HasSubstr("compression")));
}

TEST(JobsVerbTest, AJobThatIsOverCannotBeCancelled) {
  const TubeFiles files;
  ASSERT_EQ(files.TrainInStore({"-q"}).code, ExitCode::kOk);
  const auto jobs = nlohmann::json::parse(files.RunInStore({"jobs", "--json"}).out);
  const std::string id = jobs[0]["id"];
  const Outcome outcome = files.RunInStore({"jobs", "cancel", id});
  EXPECT_EQ(outcome.code, ExitCode::kRefused);
  EXPECT_THAT(outcome.err, HasSubstr(id));
}

TEST(JobsVerbTest, ADeletedJobIsForgottenAndItsModelStays) {
  const TubeFiles files;
  ASSERT_EQ(files.TrainInStore({"-q"}).code, ExitCode::kOk);
  const auto jobs = nlohmann::json::parse(files.RunInStore({"jobs", "--json"}).out);
  ASSERT_EQ(files.RunInStore({"jobs", "delete", jobs[0]["id"]}).code, ExitCode::kOk);
  EXPECT_EQ(files.RunInStore({"jobs", "--json"}).out, "[]\n");
  EXPECT_EQ(nlohmann::json::parse(files.RunInStore({"models", "--json"}).out).size(), 1u);
}

TEST(JobsVerbTest, MissingIdsAreToldApart) {
  const TubeFiles files;
  for (const char* action : {"show", "cancel", "watch", "delete"}) {
    const Outcome without = files.RunInStore({"jobs", action});
    EXPECT_EQ(without.code, ExitCode::kUsage) << action;
    EXPECT_THAT(without.err, HasSubstr(std::string("'") + action + "' needs an id"));
    const Outcome unknown = files.RunInStore({"jobs", action, "77"});
    EXPECT_EQ(unknown.code, ExitCode::kNotFound) << action;
    EXPECT_THAT(unknown.err, HasSubstr("pleat jobs: there is no job 77"));
  }
  EXPECT_EQ(files.RunInStore({"jobs", "pause"}).code, ExitCode::kUsage);
}

}  // namespace
}  // namespace pleat
