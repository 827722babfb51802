// What the catalog says of jobs without reading their records.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "pleat/base/file.h"
#include "pleat/store/catalog.h"
#include "support/source_folder.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using ::testing::ElementsAre;

class CatalogJobsTest : public testing::Test {
 protected:
  absl::Status Put(const std::string& id, const std::string& state, int64_t ended = 0,
                   const std::string& project = kDefaultProject, const std::string& request = "") {
    CatalogEntry entry{.id = id, .record = "record of " + id};
    entry.project = project;
    entry.job = {.state = state, .ended_unix_ms = ended, .request_id = request};
    return catalog_->Put(EntryKind::kJob, entry);
  }
  static std::vector<std::string> JobIdsOf(const absl::StatusOr<std::vector<CatalogEntry>>& jobs) {
    std::vector<std::string> ids;
    for (const CatalogEntry& job : *jobs) ids.push_back(job.id);
    return ids;
  }
  // "project state number" of each count that is not 0.
  std::vector<std::string> Counts() {
    std::vector<std::string> texts;
    const auto counts = catalog_->CountJobs();
    for (const auto& [project, state, num] : *counts) {
      if (num != 0) texts.push_back(project + " " + state + " " + std::to_string(num));
    }
    return texts;
  }

  TemporaryFolder folder_;
  std::unique_ptr<Catalog> catalog_ = Catalog::Open(folder_.File("c.db")).value();
};

TEST_F(CatalogJobsTest, CountsFollowEveryChange) {
  ASSERT_THAT(Put("a", "queued"), IsOk());
  ASSERT_THAT(Put("b", "queued"), IsOk());
  ASSERT_THAT(Put("c", "running", 0, "robots"), IsOk());
  ASSERT_THAT(catalog_->Put(EntryKind::kModel, {"m", ""}), IsOk());
  EXPECT_THAT(Counts(), ElementsAre("default queued 2", "robots running 1"));
  ASSERT_THAT(Put("a", "succeeded", 5), IsOk());
  ASSERT_THAT(Put("a", "succeeded", 5), IsOk());  // no change
  EXPECT_THAT(Counts(), ElementsAre("default queued 1", "default succeeded 1", "robots running 1"));
  ASSERT_THAT(catalog_->Delete(EntryKind::kJob, "b"), IsOk());
  ASSERT_THAT(catalog_->Delete({EntryKind::kJob, "robots"}, "c"), IsOk());
  EXPECT_THAT(Counts(), ElementsAre("default succeeded 1"));
}

TEST_F(CatalogJobsTest, UnfinishedOnesComeInTheOrderOfTheirCreation) {
  ASSERT_THAT(Put("a", "queued"), IsOk());
  ASSERT_THAT(Put("b", "failed", 1), IsOk());
  ASSERT_THAT(Put("c", "queued", 0, "robots"), IsOk());
  ASSERT_THAT(Put("a", "running"), IsOk());
  ASSERT_THAT(Put("d", ""), IsOk());
  EXPECT_THAT(JobIdsOf(catalog_->ListUnfinishedJobs()), ElementsAre("a", "c"));
  EXPECT_EQ(catalog_->ListUnfinishedJobs()->at(0).record, "record of a");
  EXPECT_THAT(JobIdsOf(catalog_->ListUnnotedJobs(0, 10)), ElementsAre("d"));
  const int64_t position = catalog_->Get(EntryKind::kJob, "d")->position;
  EXPECT_TRUE(catalog_->ListUnnotedJobs(position, 10)->empty());
}

TEST_F(CatalogJobsTest, EndedOnesComeInTheOrderOfTheirEnd) {
  ASSERT_THAT(Put("late", "succeeded", 300), IsOk());
  ASSERT_THAT(Put("early", "failed", 100), IsOk());
  ASSERT_THAT(Put("unknown", "cancelled"), IsOk());
  ASSERT_THAT(Put("runs", "running"), IsOk());
  ASSERT_THAT(Put("other", "failed", 50, "robots"), IsOk());
  const auto ended = [&](int64_t from, int64_t before, int max) {
    return JobIdsOf(catalog_->ListEndedJobs(kDefaultProject, from, before, max));
  };
  EXPECT_THAT(ended(0, INT64_MAX, 10), ElementsAre("unknown", "early", "late"));
  EXPECT_THAT(ended(1, 300, 10), ElementsAre("early"));
  EXPECT_THAT(ended(0, INT64_MAX, 2), ElementsAre("unknown", "early"));
}

TEST_F(CatalogJobsTest, ARequestFindsTheNewestJobOfItsProject) {
  ASSERT_THAT(Put("a", "queued", 0, "robots", "once"), IsOk());
  ASSERT_THAT(Put("b", "queued", 0, kDefaultProject, "once"), IsOk());
  EXPECT_EQ(catalog_->FindJobOfRequest("robots", "once")->id, "a");
  EXPECT_EQ(catalog_->FindJobOfRequest(kDefaultProject, "once")->id, "b");
  ASSERT_THAT(Put("c", "queued", 0, "robots", "once"), IsOk());
  EXPECT_EQ(catalog_->FindJobOfRequest("robots", "once")->id, "c");
  EXPECT_THAT(catalog_->FindJobOfRequest("ghosts", "once"),
              HasStatus(absl::StatusCode::kNotFound, testing::_));
  EXPECT_THAT(catalog_->FindJobOfRequest("robots", ""),
              HasStatus(absl::StatusCode::kNotFound, testing::_));
}

TEST_F(CatalogJobsTest, AllOfThemArePutOrNone) {
  ASSERT_THAT(catalog_->PutAll(EntryKind::kJob, {{"a", "1"}, {"b", "2"}}), IsOk());
  EXPECT_EQ(catalog_->List(EntryKind::kJob)->size(), 2u);
  ASSERT_THAT(catalog_->PutAll(EntryKind::kJob, {}), IsOk());
  catalog_.reset();
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto reader, Catalog::OpenReadOnly(folder_.File("c.db")));
  EXPECT_FALSE(reader->PutAll(EntryKind::kJob, {{"c", "3"}}).ok());
  EXPECT_EQ(reader->List(EntryKind::kJob)->size(), 2u);
}

// Version 4 knew of jobs only what their records say.
TEST(CatalogOfVersion4Test, ItsJobsHaveNoStateUntilItIsNoted) {
  TemporaryFolder folder;
  const std::string path = folder.File("catalogue.db");
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::string golden,
                             ReadFile(InSourceFolder("tests/golden/records/catalog_v4.db")));
  ASSERT_THAT(WriteFile(path, golden), IsOk());
  {
    PLEAT_ASSERT_OK_AND_ASSIGN(const auto catalog, Catalog::OpenReadOnly(path));
    EXPECT_EQ(catalog->List(EntryKind::kJob)->size(), 3u);
  }
  for (int start = 0; start < 2; ++start) {  // the second finds the new version
    PLEAT_ASSERT_OK_AND_ASSIGN(const auto catalog, Catalog::Open(path));
    PLEAT_ASSERT_OK_AND_ASSIGN(const auto jobs, catalog->ListUnnotedJobs(0, 10));
    ASSERT_EQ(jobs.size(), 3u);
    EXPECT_EQ(jobs[2].id, "job-3");
    EXPECT_EQ(jobs[2].project, "robots");
    EXPECT_EQ(jobs[2].job.state, "");
    EXPECT_EQ(catalog->CountJobs()->size(), 2u);
    EXPECT_EQ(catalog->FileIds()->size(), 3u);
    EXPECT_EQ(catalog->List(EntryKind::kModel)->size(), 1u);
    EXPECT_EQ(catalog->Secret()->size(), 64u);
  }
}

}  // namespace
}  // namespace pleat
