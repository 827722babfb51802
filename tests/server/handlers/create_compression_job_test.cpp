#include "server/handlers/handler_checks.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

TEST(CreateCompressionJob, HandsOverSequenceAndGoal) {
  MockContext mock;
  JobInfo info;
  info.id = "job-1";
  info.options = CompressOptions{};
  CompressionRequest asked;
  EXPECT_CALL(mock.jobs, CreateCompression)
      .WillOnce(testing::DoAll(testing::SaveArg<0>(&asked), testing::Return(info)));
  v1::CreateCompressionJobRequest request;
  v1::CreateCompressionJobResponse response;
  request.set_sequence_id(kId);
  request.set_request_id("again");
  request.mutable_options()->set_lossless_at_bits(11);
  request.mutable_options()->set_any_face_order(true);
  ASSERT_THAT(CreateCompressionJob(mock.context, "ada", request, &response), IsOk());
  EXPECT_EQ(response.job().id(), "job-1");
  EXPECT_EQ(asked.sequence_id, kId);
  EXPECT_EQ(asked.request_id, "again");
  EXPECT_EQ(asked.client, "ada");
  EXPECT_EQ(asked.options.goal, CompressionGoal::kGrid);
  EXPECT_EQ(asked.options.grid_bits, 11);
  EXPECT_FALSE(asked.options.keep_face_order);
}

TEST(CreateCompressionJob, WhatIsWrongNeverReachesTheService) {
  MockContext mock;
  v1::CreateCompressionJobRequest request;
  v1::CreateCompressionJobResponse response;
  request.set_sequence_id(kPathId);
  request.mutable_options()->set_max_error_mm(1);
  EXPECT_THAT(CreateCompressionJob(mock.context, "ada", request, &response),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("sequence_id")));
  request.set_sequence_id(kId);
  request.set_request_id(std::string(65, 'r'));
  EXPECT_THAT(CreateCompressionJob(mock.context, "ada", request, &response),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("request_id")));
  request.clear_request_id();
  request.mutable_options()->set_max_error_mm(-1);
  EXPECT_THAT(CreateCompressionJob(mock.context, "ada", request, &response),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("max_error_mm")));
  request.mutable_options()->clear_max_error_mm();  // no goal at all
  EXPECT_THAT(CreateCompressionJob(mock.context, "ada", request, &response),
              HasStatus(absl::StatusCode::kInvalidArgument, testing::_));
}

}  // namespace
}  // namespace pleat
