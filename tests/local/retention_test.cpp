#include "pleat/local/retention.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "data_folder.h"
#include "job_rows.h"
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

class RetentionTest : public testing::Test {
 protected:
  RetentionTest() { folder_.Open(); }
  size_t Run(const RetentionRules& rules = {}) {
    removed_.clear();
    return RunRetention(
        {.files = &folder_.files(),
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
    PutJob(job);
  }
  void PutJob(const JobInfo& job) {
    EXPECT_THAT(folder_.files().store().catalog().Put(EntryKind::kJob, JobEntry(job, 1)), IsOk());
  }
  // A job of the project that ended so long ago; none: it does not know when.
  void AddEndedJob(const std::string& id, std::optional<absl::Duration> ago,
                   const std::string& project = kDefaultProject) {
    JobInfo job;
    job.id = id;
    job.state = JobState::kSucceeded;
    job.project = project;
    if (ago) job.ended = folder_.now() - *ago;
    PutJob(job);
  }
  // The ids of the jobs that are left, of all projects.
  std::vector<std::string> JobIds() {
    std::vector<std::string> ids;
    const auto entries = folder_.files().store().catalog().List(EntryKind::kJob);
    for (const CatalogEntry& entry : *entries) ids.push_back(entry.id);
    return ids;
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

TEST_F(RetentionTest, NoJobGoesWithoutARule) {
  AddEndedJob("a", absl::Hours(1'000'000));
  AddEndedJob("b", std::nullopt);
  EXPECT_EQ(Run(), 0u);
}

TEST_F(RetentionTest, TheNewestStayByTheirEndAndNotByTheirCreation) {
  AddEndedJob("a", absl::Hours(1));
  AddEndedJob("b", absl::Hours(3));
  AddEndedJob("old", std::nullopt);  // of a version that wrote no times
  AddEndedJob("c", absl::Hours(2));
  EXPECT_EQ(Run({.max_ended_jobs = 4}), 0u);
  EXPECT_EQ(Run({.max_ended_jobs = 3}), 1u);
  EXPECT_THAT(removed_, ElementsAre(AllOf(HasSubstr("old"), HasSubstr("newest 3"))));
  EXPECT_EQ(Run({.max_ended_jobs = 2}), 1u);
  EXPECT_THAT(JobIds(), ElementsAre("a", "c"));
}

TEST_F(RetentionTest, AJobGoesWhenItIsOlderThanTheAge) {
  AddEndedJob("a", absl::Hours(2) + absl::Seconds(1));
  AddEndedJob("b", absl::Hours(2));
  AddEndedJob("old", std::nullopt);
  EXPECT_EQ(Run({.max_job_age = absl::Hours(2)}), 1u);
  EXPECT_THAT(removed_, ElementsAre(AllOf(HasSubstr("'a'"), HasSubstr("more than 2h ago"))));
}

TEST_F(RetentionTest, EachRuleRemovesTheJobsThatItNames) {
  AddEndedJob("a", absl::Hours(1));
  AddEndedJob("b", absl::Minutes(3));
  AddEndedJob("c", absl::Minutes(2));
  AddEndedJob("d", absl::Hours(9));
  EXPECT_EQ(Run({.max_ended_jobs = 2, .max_job_age = absl::Hours(2)}), 2u);
  EXPECT_THAT(removed_, ElementsAre(AllOf(HasSubstr("'d'"), HasSubstr("ago")),
                                    AllOf(HasSubstr("'a'"), HasSubstr("newest 2"))));
}

TEST_F(RetentionTest, EachProjectKeepsItsNewestJobs) {
  for (const char* id : {"r1", "r2", "r3"}) AddEndedJob(id, absl::Hours(1), "robots");
  AddEndedJob("d1", absl::Hours(9));
  EXPECT_EQ(Run({.max_ended_jobs = 1}), 2u);
  EXPECT_THAT(JobIds(), ElementsAre("r3", "d1"));
}

TEST_F(RetentionTest, MoreJobsThanAreInMemoryTogetherGoInOneRun) {
  std::vector<CatalogEntry> rows;
  JobInfo job;
  job.state = JobState::kFailed;
  job.ended = folder_.now();
  for (int i = 0; i < 2500; ++i) {
    job.id = absl::StrCat("job-", i);
    rows.push_back(JobEntry(job, 1));
  }
  ASSERT_THAT(folder_.files().store().catalog().PutAll(EntryKind::kJob, rows), IsOk());
  EXPECT_EQ(Run({.max_ended_jobs = 2490}), 10u);
  EXPECT_EQ(Run(), 0u);
  folder_.Pass(absl::Hours(2));
  EXPECT_EQ(Run({.max_ended_jobs = 1400, .max_job_age = absl::Hours(9)}), 1090u);
}

// Rows of older versions say what they are in their record alone.
TEST_F(RetentionTest, JobsOfOlderVersionsAreKnownByTheirRecords) {
  const std::string id = Upload("a", absl::Hours(1));
  JobInfo job;
  job.id = "job-1";
  job.state = JobState::kRunning;
  job.sequence_ids = {id};
  ASSERT_THAT(folder_.files().catalog().Put(EntryKind::kJob, {"job-1", EncodeRecord(job)}), IsOk());
  job.id = "job-2";
  job.state = JobState::kFailed;
  ASSERT_THAT(folder_.files().catalog().Put(EntryKind::kJob, {"job-2", EncodeRecord(job)}), IsOk());
  AddEndedJob("new", absl::Hours(0));
  folder_.Pass(absl::Hours(2));
  EXPECT_EQ(Run({.max_ended_jobs = 1}), 1u);
  EXPECT_THAT(JobIds(), ElementsAre("job-1", "new"));
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
