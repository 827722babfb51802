#include "server/handlers/handler_checks.h"

namespace pleat {
namespace {

TEST(GetModel, SaysWhatTheServiceKnows) {
  MockContext mock;
  ModelInfo info;
  info.id = kId;
  info.name = "tube";
  info.size_bytes = 123;
  EXPECT_CALL(mock.models, Get(kId)).WillOnce(testing::Return(info));
  v1::GetModelRequest request;
  v1::GetModelResponse response;
  request.set_id(kId);
  ASSERT_THAT(GetModel(mock.context, request, &response), IsOk());
  EXPECT_EQ(response.model().id(), kId);
  EXPECT_EQ(response.model().name(), "tube");
  EXPECT_EQ(response.model().size_bytes(), 123u);
}

TEST(GetModel, AnIdThatIsNoneNeverReachesTheService) {
  MockContext mock;
  for (const std::string& id : {std::string(), std::string("abc"), kPathId}) {
    v1::GetModelRequest request;
    v1::GetModelResponse response;
    request.set_id(id);
    EXPECT_THAT(GetModel(mock.context, request, &response),
                HasStatus(absl::StatusCode::kInvalidArgument, testing::HasSubstr("id")));
  }
}

TEST(GetModel, PassesOnThatThereIsNone) {
  MockContext mock;
  EXPECT_CALL(mock.models, Get(kId)).WillOnce(testing::Return(absl::NotFoundError("none")));
  v1::GetModelRequest request;
  v1::GetModelResponse response;
  request.set_id(kId);
  EXPECT_THAT(GetModel(mock.context, request, &response),
              HasStatus(absl::StatusCode::kNotFound, "none"));
}

}  // namespace
}  // namespace pleat
