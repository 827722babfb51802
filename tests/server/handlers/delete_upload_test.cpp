#include "server/handlers/handler_checks.h"

namespace pleat {
namespace {

absl::Status Delete(MockContext& mock, const std::string& id) {
  v1::DeleteUploadRequest request;
  v1::DeleteUploadResponse response;
  request.set_id(id);
  return DeleteUpload(mock.context, request, &response);
}

TEST(DeleteUpload, PassesOnHowItEnded) {
  MockContext mock;
  EXPECT_CALL(mock.sequences, DeleteUpload(kId))
      .WillOnce(testing::Return(absl::OkStatus()))
      .WillOnce(testing::Return(absl::AbortedError("another writer")));
  EXPECT_THAT(Delete(mock, kId), IsOk());
  EXPECT_THAT(Delete(mock, kId), HasStatus(absl::StatusCode::kAborted, "another writer"));
}

TEST(DeleteUpload, AnIdThatIsNoneNeverReachesTheService) {
  MockContext mock;
  for (const std::string& id : {std::string(), kPathId}) {
    EXPECT_THAT(Delete(mock, id), HasStatus(absl::StatusCode::kInvalidArgument, testing::_));
  }
}

}  // namespace
}  // namespace pleat
