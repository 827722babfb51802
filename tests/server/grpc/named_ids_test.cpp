#include "named_ids.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pleat/v1/job_service.pb.h"
#include "pleat/v1/pose_service.pb.h"
#include "pleat/v1/sequence_service.pb.h"

namespace pleat {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(NamedIdsTest, FindsIdsWhereRequestsHaveThem) {
  v1::GetJobRequest job;
  EXPECT_THAT(NamedIds(job), IsEmpty());
  job.set_id("job-1");
  EXPECT_THAT(NamedIds(job), ElementsAre("job-1"));
  v1::CreateTrainingJobRequest training;
  training.add_sequence_ids("a");
  training.add_sequence_ids("b");
  training.set_model_name("not an id");
  EXPECT_THAT(NamedIds(training), ElementsAre("a", "b"));
  v1::UploadSequenceRequest upload;
  upload.mutable_header()->set_id("content");
  EXPECT_THAT(NamedIds(upload), ElementsAre("content"));
}

TEST(NamedIdsTest, TakesLittleOfWhatIsTooMuch) {
  v1::CreateTrainingJobRequest training;
  for (int i = 0; i < 1000; ++i) training.add_sequence_ids(std::string(1000, 'x'));
  const std::vector<std::string> ids = NamedIds(training);
  EXPECT_EQ(ids.size(), 8);
  for (const std::string& id : ids) EXPECT_EQ(id.size(), 64);
}

}  // namespace
}  // namespace pleat
