#include "server/handlers/handler_checks.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

TEST(GetStreamHeader, IsThatOfASessionWithTheSameOptions) {
  MockContext mock;
  StreamHeader header;
  header.num_vertices = 96;
  PoseSessionOptions asked;
  EXPECT_CALL(mock.poses, OpenSession(kId, testing::_))
      .WillOnce([&](const std::string&, PoseSessionOptions options) {
        asked = std::move(options);
        auto session = std::make_unique<testing::StrictMock<MockPoseSession>>();
        EXPECT_CALL(*session, header).WillOnce(testing::ReturnRef(header));
        return session;
      });
  v1::GetStreamHeaderRequest request;
  v1::GetStreamHeaderResponse response;
  request.set_model_id(kId);
  request.mutable_options()->set_position_bits(14);
  ASSERT_THAT(GetStreamHeader(mock.context, request, &response), IsOk());
  EXPECT_EQ(response.header().num_vertices(), 96);
  EXPECT_EQ(asked.encoder.position_bits, 14);
}

TEST(GetStreamHeader, WhatIsWrongNeverReachesTheService) {
  MockContext mock;
  v1::GetStreamHeaderRequest request;
  v1::GetStreamHeaderResponse response;
  request.set_model_id(kPathId);
  EXPECT_THAT(GetStreamHeader(mock.context, request, &response),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("model_id")));
  request.set_model_id(kId);
  request.mutable_options()->set_position_bits(99);
  EXPECT_THAT(GetStreamHeader(mock.context, request, &response),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("position_bits")));
}

}  // namespace
}  // namespace pleat
