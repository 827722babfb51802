#include "server/handlers/handler_checks.h"

namespace pleat {
namespace {

TEST(QueryUpload, SaysWhereToGoOn) {
  MockContext mock;
  EXPECT_CALL(mock.sequences, QueryUpload(kId))
      .WillOnce(testing::Return(UploadStatus{.received_bytes = 100, .complete = false}))
      .WillOnce(testing::Return(UploadStatus{.received_bytes = 300, .complete = true}));
  v1::QueryUploadRequest request;
  v1::QueryUploadResponse response;
  request.set_id(kId);
  ASSERT_THAT(QueryUpload(mock.context, request, &response), IsOk());
  EXPECT_EQ(response.received_bytes(), 100u);
  EXPECT_FALSE(response.complete());
  ASSERT_THAT(QueryUpload(mock.context, request, &response), IsOk());
  EXPECT_EQ(response.received_bytes(), 300u);
  EXPECT_TRUE(response.complete());
}

TEST(QueryUpload, AnIdThatIsNoneNeverReachesTheService) {
  MockContext mock;
  v1::QueryUploadRequest request;
  v1::QueryUploadResponse response;
  request.set_id(kPathId);
  EXPECT_THAT(QueryUpload(mock.context, request, &response),
              HasStatus(absl::StatusCode::kInvalidArgument, testing::HasSubstr("id")));
}

}  // namespace
}  // namespace pleat
