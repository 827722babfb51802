#include "server/handlers/handler_checks.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

v1::CreateTrainingJobRequest GoodRequest() {
  v1::CreateTrainingJobRequest request;
  request.add_sequence_ids(kId);
  request.add_sequence_ids(std::string(64, 'b'));
  request.mutable_options()->set_seed(7);
  request.set_model_name("mine");
  request.set_rig("{}");
  request.set_request_id("again");
  return request;
}

TEST(CreateTrainingJob, HandsOverAllThatWasAsked) {
  MockContext mock;
  JobInfo info;
  info.id = "job-1";
  TrainingRequest asked;
  EXPECT_CALL(mock.jobs, CreateTraining)
      .WillOnce(testing::DoAll(testing::SaveArg<0>(&asked), testing::Return(info)));
  v1::CreateTrainingJobResponse response;
  ASSERT_THAT(CreateTrainingJob(mock.context, "ada", GoodRequest(), &response), IsOk());
  EXPECT_EQ(response.job().id(), "job-1");
  EXPECT_EQ(response.job().state(), v1::JOB_STATE_QUEUED);
  EXPECT_THAT(asked.sequence_ids, testing::ElementsAre(kId, std::string(64, 'b')));
  EXPECT_EQ(asked.options.seed, 7u);
  EXPECT_EQ(asked.model_name, "mine");
  EXPECT_EQ(asked.rig, "{}");
  EXPECT_EQ(asked.request_id, "again");
  EXPECT_EQ(asked.client, "ada");
}

TEST(CreateTrainingJob, WhatIsWrongNeverReachesTheService) {
  MockContext mock;
  v1::CreateTrainingJobResponse response;
  v1::CreateTrainingJobRequest bad_id = GoodRequest();
  bad_id.set_sequence_ids(1, kPathId);
  EXPECT_THAT(CreateTrainingJob(mock.context, "ada", bad_id, &response),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("sequence_ids")));
  v1::CreateTrainingJobRequest long_name = GoodRequest();
  long_name.set_model_name(std::string(257, 'n'));
  EXPECT_THAT(CreateTrainingJob(mock.context, "ada", long_name, &response),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("model_name")));
}

TEST(CreateTrainingJob, PassesOnThatTheQueueIsFull) {
  MockContext mock;
  EXPECT_CALL(mock.jobs, CreateTraining)
      .WillOnce(testing::Return(absl::ResourceExhaustedError("full")));
  v1::CreateTrainingJobResponse response;
  EXPECT_THAT(CreateTrainingJob(mock.context, "ada", GoodRequest(), &response),
              HasStatus(absl::StatusCode::kResourceExhausted, "full"));
}

}  // namespace
}  // namespace pleat
