#include "server/handlers/handler_checks.h"

namespace pleat {
namespace {

absl::Status DeleteId(MockContext& mock, const std::string& id) {
  v1::DeleteSequenceRequest request;
  v1::DeleteSequenceResponse response;
  request.set_id(id);
  return DeleteSequence(mock.context, request, &response);
}

TEST(DeleteSequence, PassesOnHowItEnded) {
  MockContext mock;
  EXPECT_CALL(mock.sequences, Delete(kId))
      .WillOnce(testing::Return(absl::OkStatus()))
      .WillOnce(testing::Return(absl::NotFoundError("none")));
  EXPECT_THAT(DeleteId(mock, kId), IsOk());
  EXPECT_THAT(DeleteId(mock, kId), HasStatus(absl::StatusCode::kNotFound, "none"));
}

TEST(DeleteSequence, AnIdThatIsNoneNeverReachesTheService) {
  MockContext mock;
  for (const std::string& id : {std::string(), std::string("abc"), kPathId}) {
    EXPECT_THAT(DeleteId(mock, id),
                HasStatus(absl::StatusCode::kInvalidArgument, testing::HasSubstr("id")));
  }
}

}  // namespace
}  // namespace pleat
