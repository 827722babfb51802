// Pages of jobs: their order is that of the rows, and what they say is what the workers know.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "data_folder.h"
#include "pleat/local/local_jobs.h"
#include "support/fake_training.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

class JobPagesTest : public testing::Test {
 protected:
  JobPagesTest() {
    folder_.Open();
    sequence_id_ = folder_.sequences().Upload(MakeSwayingTube(5, "a"), {})->id;
    OpenJobs();
  }
  // The jobs wait: no worker is started.
  void OpenJobs() {
    jobs_.reset();
    pool_ = std::make_unique<JobPool>(
        &folder_.files(),
        [this](const std::string&) -> const JobRunner& { return jobs_->runner(); },
        JobPoolOptions{});
    jobs_ = std::make_unique<LocalJobs>(
        &folder_.files(), &folder_.sequences(),
        JobRunner(&folder_.files(), &folder_.sequences(), TrainCharacter, 1), pool_.get());
  }
  std::string Create() { return jobs_->CreateTraining({.sequence_ids = {sequence_id_}})->id; }
  uint64_t num_steps() { return folder_.files().store().catalog().num_read_steps(); }

  DataFolder folder_;
  std::string sequence_id_;
  std::unique_ptr<JobPool> pool_;
  std::unique_ptr<LocalJobs> jobs_;
};

TEST_F(JobPagesTest, ATokenGoesOnWhereItsPageEnded) {
  std::vector<std::string> ids;
  for (int i = 0; i < 5; ++i) ids.push_back(Create());
  PageRequest request{.size = 2};
  std::vector<std::string> listed;
  std::vector<size_t> sizes;
  do {
    PLEAT_ASSERT_OK_AND_ASSIGN(const Page<JobInfo> page, jobs_->ListPage(request));
    for (const JobInfo& job : page.items) listed.push_back(job.id);
    sizes.push_back(page.items.size());
    request.token = page.next_token;
  } while (!request.token.empty());
  EXPECT_EQ(listed, ids);
  EXPECT_THAT(sizes, testing::ElementsAre(2, 2, 1));
  EXPECT_EQ(jobs_->ListPage({.size = 5})->next_token, "");  // a full page may be the last one
  EXPECT_THAT(jobs_->ListPage({.size = 501}),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("page_size")));
  EXPECT_THAT(jobs_->ListPage({.token = ids[0]}),  // as 0.1.0 had them
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("older version")));
}

TEST_F(JobPagesTest, ATokenSurvivesARestart) {
  std::vector<std::string> ids;
  for (int i = 0; i < 3; ++i) ids.push_back(Create());
  const std::string token = jobs_->ListPage({.size = 1})->next_token;
  jobs_.reset();
  folder_.Open();
  OpenJobs();
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto page, jobs_->ListPage({.token = token}));
  ASSERT_EQ(page.items.size(), 2u);
  EXPECT_EQ(page.items[0].id, ids[1]);
}

TEST_F(JobPagesTest, ARowThatCannotBeReadHidesNoOther) {
  std::vector<std::string> ids;
  for (int i = 0; i < 3; ++i) ids.push_back(Create());
  jobs_.reset();
  ASSERT_THAT(folder_.files().catalog().Put(EntryKind::kJob, {ids[0], "\xff\xff"}), IsOk());
  folder_.Open();
  OpenJobs();
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto page, jobs_->ListPage({.size = 1}));
  EXPECT_TRUE(page.items.empty());
  EXPECT_EQ(jobs_->ListPage({.size = 1, .token = page.next_token})->items.at(0).id, ids[1]);
  EXPECT_EQ(jobs_->List()->size(), 2u);
  EXPECT_THAT(folder_.problems(), testing::Contains(HasSubstr(ids[0])));
}

// Each page was paid with all rows before.
TEST_F(JobPagesTest, TwiceAsManyJobsCostTwiceAsMuch) {
  const auto steps_of_list = [&] {
    const uint64_t before = num_steps();
    PageRequest request{.size = 10};
    do {
      request.token = jobs_->ListPage(request)->next_token;
    } while (!request.token.empty());
    return static_cast<double>(num_steps() - before);
  };
  for (int i = 0; i < 100; ++i) Create();
  const double steps = steps_of_list();
  for (int i = 0; i < 100; ++i) Create();
  EXPECT_NEAR(steps_of_list() / steps, 2, .1);
}

}  // namespace
}  // namespace pleat
