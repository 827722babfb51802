#include "server/handlers/handler_checks.h"

namespace pleat {
namespace {

TEST(GetSequence, SaysWhatTheServiceKnows) {
  MockContext mock;
  SequenceInfo info;
  info.id = kId;
  info.name = "tube";
  info.size_bytes = 123;
  EXPECT_CALL(mock.sequences, Get(kId)).WillOnce(testing::Return(info));
  v1::GetSequenceRequest request;
  v1::GetSequenceResponse response;
  request.set_id(kId);
  ASSERT_THAT(GetSequence(mock.context, request, &response), IsOk());
  EXPECT_EQ(response.sequence().id(), kId);
  EXPECT_EQ(response.sequence().name(), "tube");
  EXPECT_EQ(response.sequence().size_bytes(), 123u);
}

TEST(GetSequence, AnIdThatIsNoneNeverReachesTheService) {
  MockContext mock;
  for (const std::string& id : {std::string(), std::string("abc"), kPathId}) {
    v1::GetSequenceRequest request;
    v1::GetSequenceResponse response;
    request.set_id(id);
    EXPECT_THAT(GetSequence(mock.context, request, &response),
                HasStatus(absl::StatusCode::kInvalidArgument, testing::HasSubstr("id")));
  }
}

TEST(GetSequence, PassesOnThatThereIsNone) {
  MockContext mock;
  EXPECT_CALL(mock.sequences, Get(kId)).WillOnce(testing::Return(absl::NotFoundError("none")));
  v1::GetSequenceRequest request;
  v1::GetSequenceResponse response;
  request.set_id(kId);
  EXPECT_THAT(GetSequence(mock.context, request, &response),
              HasStatus(absl::StatusCode::kNotFound, "none"));
}

}  // namespace
}  // namespace pleat
