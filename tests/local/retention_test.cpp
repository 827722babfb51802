#include "pleat/local/retention.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "data_folder.h"
#include "pleat/base/sha256.h"
#include "pleat/store/records.h"
#include "support/fake_training.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const absl::Time kNow = absl::FromUnixSeconds(1'800'000'000);

EndedJob JobThatEnded(const std::string& id, absl::Duration ago) {
  return {.id = id, .name = "walk", .ended = kNow - ago};
}

std::vector<std::string> ChosenIds(const std::vector<EndedJob>& jobs, const RetentionRules& rules) {
  std::vector<std::string> ids;
  for (const JobToRemove& it : ChooseJobsToRemove(jobs, rules, kNow)) ids.push_back(it.job.id);
  return ids;
}

TEST(RetentionOfJobs, NothingGoesWithoutARule) {
  EXPECT_THAT(ChosenIds({JobThatEnded("a", absl::Hours(1'000'000)), {.id = "b"}}, {}), IsEmpty());
}

TEST(RetentionOfJobs, TheNewestStayByTheirEndAndNotByTheirCreation) {
  const std::vector<EndedJob> jobs = {JobThatEnded("a", absl::Hours(1)),
                                      JobThatEnded("b", absl::Hours(3)),
                                      {.id = "old"},  // of a version that wrote no times
                                      JobThatEnded("c", absl::Hours(2))};
  EXPECT_THAT(ChosenIds(jobs, {.max_ended_jobs = 2}), ElementsAre("old", "b"));
  EXPECT_THAT(ChosenIds(jobs, {.max_ended_jobs = 4}), IsEmpty());
  EXPECT_THAT(ChooseJobsToRemove(jobs, {.max_ended_jobs = 3}, kNow).at(0).why,
              HasSubstr("newest 3"));
}

TEST(RetentionOfJobs, AJobGoesWhenItIsOlderThanTheAge) {
  const RetentionRules rules{.max_job_age = absl::Hours(2)};
  const std::vector<EndedJob> jobs = {JobThatEnded("a", absl::Hours(2) + absl::Seconds(1)),
                                      JobThatEnded("b", absl::Hours(2)),
                                      {.id = "old"}};
  EXPECT_THAT(ChosenIds(jobs, rules), ElementsAre("a"));
  EXPECT_THAT(ChooseJobsToRemove(jobs, rules, kNow).at(0).why, HasSubstr("more than 2h ago"));
}

TEST(RetentionOfJobs, EachRuleRemovesWhatItNames) {
  const RetentionRules rules{.max_ended_jobs = 2, .max_job_age = absl::Hours(2)};
  EXPECT_THAT(ChosenIds({JobThatEnded("a", absl::Hours(1)), JobThatEnded("b", absl::Minutes(3)),
                         JobThatEnded("c", absl::Minutes(2)), JobThatEnded("d", absl::Hours(9))},
                        rules),
              ElementsAre("d", "a"));
}

class RetentionTest : public testing::Test {
 protected:
  RetentionTest() { folder_.Open(); }
  size_t Run(const RetentionRules& rules = {}) {
    removed_.clear();
    return RunRetention(
        {.files = &folder_.files(),
         .jobs = JobsInRows(&folder_.files()),
         .on_model_removed = [this](const std::string& id) { models_removed_.push_back(id); },
         .on_removed = [this](const std::string& text) { removed_.push_back(text); }},
        rules);
  }
  std::string Upload(const std::string& name, absl::Duration ttl, int num_frames = 3) {
    return folder_.sequences().Upload(MakeSwayingTube(num_frames, name), {}, ttl)->id;
  }
  // A file that is no model but stands as one.
  std::string AddModel(const std::string& content, absl::Duration ttl) {
    const std::string id = ToHex(ComputeSha256(content));
    EXPECT_THAT(folder_.files().Add(EntryKind::kModel, {id, "?"}, content, ttl), IsOk());
    return id;
  }
  void AddJob(const std::string& id, JobState state, const std::string& sequence_id = "") {
    JobInfo job;
    job.id = id;
    job.name = "dance";
    job.state = state;
    if (!sequence_id.empty()) job.sequence_ids = {sequence_id};
    if (IsFinal(state)) job.ended = folder_.now();
    EXPECT_THAT(folder_.files().catalog().Put(EntryKind::kJob, {id, EncodeRecord(job)}), IsOk());
  }
  bool Has(const std::string& id) { return folder_.sequences().Get(id).ok(); }

  DataFolder folder_;
  std::vector<std::string> removed_, models_removed_;
};

TEST_F(RetentionTest, AnEntryGoesWithItsFileWhenItsTimeIsOverAndNotBefore) {
  const std::string brief = Upload("brief", absl::Hours(1)), stays = Upload("stays", kKeepForEver);
  folder_.Pass(absl::Hours(1) - absl::Milliseconds(1));
  EXPECT_EQ(Run(), 0u);
  folder_.Pass(absl::Milliseconds(1));
  EXPECT_EQ(Run(), 1u);
  EXPECT_THAT(removed_, ElementsAre(AllOf(HasSubstr("sequence"), HasSubstr(brief),
                                          HasSubstr("'brief'"), HasSubstr("time to live"))));
  EXPECT_FALSE(Has(brief));
  EXPECT_FALSE(std::filesystem::exists(folder_.PathOf(brief)));
  EXPECT_TRUE(Has(stays));
  EXPECT_TRUE(folder_.files().IsIntact(stays));
  EXPECT_EQ(Run(), 0u);
  EXPECT_THAT(folder_.problems(), IsEmpty());
}

TEST_F(RetentionTest, WhatIsPinnedStaysUntilItIsUnpinned) {
  const std::string id = Upload("a", absl::Hours(1));
  ASSERT_THAT(folder_.sequences().SetPinned(id, true), IsOk());
  EXPECT_TRUE(folder_.sequences().Get(id)->life.pinned);
  folder_.Pass(absl::Hours(100));
  EXPECT_EQ(Run(), 0u);
  EXPECT_TRUE(Has(id));
  ASSERT_THAT(folder_.sequences().SetPinned(id, false), IsOk());
  EXPECT_EQ(Run(), 1u);
  EXPECT_FALSE(Has(id));
  EXPECT_THAT(folder_.sequences().SetPinned(id, true),
              HasStatus(absl::StatusCode::kNotFound, HasSubstr(id)));
}

TEST_F(RetentionTest, ASequenceThatAJobWorksOnStaysUntilTheJobEnds) {
  const std::string id = Upload("a", absl::Hours(1));
  AddJob("job-1", JobState::kQueued, id);
  folder_.Pass(absl::Hours(2));
  EXPECT_EQ(Run(), 0u);
  AddJob("job-1", JobState::kFailed, id);
  EXPECT_EQ(Run(), 1u);
  EXPECT_FALSE(Has(id));
}

TEST_F(RetentionTest, ModelsGoFromTheMemoryAsWell) {
  const std::string brief = AddModel("brief", absl::Seconds(1));
  AddModel("stays", kKeepForEver);
  folder_.Pass(absl::Seconds(1));
  EXPECT_EQ(Run(), 1u);
  EXPECT_THAT(models_removed_, ElementsAre(brief));
  EXPECT_THAT(removed_, ElementsAre(HasSubstr(brief)));  // although its row says no name
}

TEST_F(RetentionTest, JobsGoByTheirRulesAndTheirSequencesStay) {
  const std::string id = Upload("a", kKeepForEver);
  AddJob("job-1", JobState::kSucceeded, id);
  folder_.Pass(absl::Hours(1));
  AddJob("job-2", JobState::kCancelled, id);
  AddJob("job-3", JobState::kRunning, id);
  EXPECT_EQ(Run({.max_ended_jobs = 1}), 1u);
  EXPECT_THAT(removed_, ElementsAre(AllOf(HasSubstr("job-1"), HasSubstr("'dance'"))));
  folder_.Pass(absl::Hours(1));
  EXPECT_EQ(Run({.max_job_age = absl::Minutes(59)}), 1u);
  EXPECT_THAT(removed_, ElementsAre(HasSubstr("job-2")));
  EXPECT_EQ(folder_.files().store().catalog().List(EntryKind::kJob)->size(), 1u);
  EXPECT_TRUE(Has(id));
}

TEST_F(RetentionTest, UploadsThatNobodyGoesOnWithAreForgotten) {
  const std::string id(64, 'a'), held_id(64, 'b');
  for (const std::string& it : {id, held_id}) {
    PLEAT_ASSERT_OK_AND_ASSIGN(const auto upload, folder_.files().BeginUpload(it, 100, 0));
    ASSERT_THAT(upload.upload->Append("some bytes"), IsOk());
  }
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto held, folder_.files().BeginUpload(held_id, 100, 10));
  // The files have the time of this machine; the folder's clock goes there.
  folder_.Pass(SystemTime() - folder_.now() + absl::Hours(2));
  EXPECT_EQ(Run({.max_upload_age = absl::Hours(3)}), 0u);
  EXPECT_EQ(Run({.max_upload_age = absl::Hours(1)}), 1u);
  EXPECT_THAT(removed_, ElementsAre(AllOf(HasSubstr("upload"), HasSubstr(id))));
  EXPECT_EQ(folder_.files().store().uploads().ReceivedBytes(id), 0u);
  EXPECT_EQ(folder_.files().store().uploads().ReceivedBytes(held_id), 10u);
}

TEST_F(RetentionTest, WhatCannotBeRemovedIsReportedAndTheOthersGo) {
  const std::string id = Upload("a", absl::Hours(1)), other = Upload("b", absl::Hours(1), 4);
  folder_.Pass(absl::Hours(1));
  // A folder that is not empty stands where the file was, so the file cannot be removed.
  std::filesystem::remove(folder_.PathOf(id));
  std::filesystem::create_directory(folder_.PathOf(id));
  std::ofstream(folder_.PathOf(id) + "/in_the_way") << "x";
  EXPECT_EQ(Run(), 1u);
  EXPECT_THAT(folder_.problems(), ElementsAre(AllOf(HasSubstr("retention"), HasSubstr(id))));
  EXPECT_FALSE(Has(other));
  // The row is gone, and the catalog remembers that the file must go.
  EXPECT_THAT(folder_.files().store().catalog().PendingRemovals().value(), ElementsAre(id));
}

}  // namespace
}  // namespace pleat
