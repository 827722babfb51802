#include "server/handlers/handler_checks.h"

namespace pleat {
namespace {

absl::Status DeleteId(MockContext& mock, const std::string& id) {
  v1::DeleteModelRequest request;
  v1::DeleteModelResponse response;
  request.set_id(id);
  return DeleteModel(mock.context, request, &response);
}

TEST(DeleteModel, PassesOnHowItEnded) {
  MockContext mock;
  EXPECT_CALL(mock.models, Delete(kId))
      .WillOnce(testing::Return(absl::OkStatus()))
      .WillOnce(testing::Return(absl::NotFoundError("none")));
  EXPECT_THAT(DeleteId(mock, kId), IsOk());
  EXPECT_THAT(DeleteId(mock, kId), HasStatus(absl::StatusCode::kNotFound, "none"));
}

TEST(DeleteModel, AnIdThatIsNoneNeverReachesTheService) {
  MockContext mock;
  for (const std::string& id : {std::string(), std::string("abc"), kPathId}) {
    EXPECT_THAT(DeleteId(mock, id),
                HasStatus(absl::StatusCode::kInvalidArgument, testing::HasSubstr("id")));
  }
}

}  // namespace
}  // namespace pleat
