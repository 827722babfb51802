#include "server/handlers/handler_checks.h"

namespace pleat {
namespace {

TEST(GetCompressedSequence, SaysWhatTheServiceKnows) {
  MockContext mock;
  CompressedSequenceInfo info;
  info.id = kId;
  info.name = "tube";
  info.size_bytes = 123;
  EXPECT_CALL(mock.compressed_sequences, Get(kId)).WillOnce(testing::Return(info));
  v1::GetCompressedSequenceRequest request;
  v1::GetCompressedSequenceResponse response;
  request.set_id(kId);
  ASSERT_THAT(GetCompressedSequence(mock.context, request, &response), IsOk());
  EXPECT_EQ(response.compressed_sequence().id(), kId);
  EXPECT_EQ(response.compressed_sequence().name(), "tube");
  EXPECT_EQ(response.compressed_sequence().size_bytes(), 123u);
}

TEST(GetCompressedSequence, AnIdThatIsNoneNeverReachesTheService) {
  MockContext mock;
  for (const std::string& id : {std::string(), std::string("abc"), kPathId}) {
    v1::GetCompressedSequenceRequest request;
    v1::GetCompressedSequenceResponse response;
    request.set_id(id);
    EXPECT_THAT(GetCompressedSequence(mock.context, request, &response),
                HasStatus(absl::StatusCode::kInvalidArgument, testing::HasSubstr("id")));
  }
}

TEST(GetCompressedSequence, PassesOnThatThereIsNone) {
  MockContext mock;
  EXPECT_CALL(mock.compressed_sequences, Get(kId))
      .WillOnce(testing::Return(absl::NotFoundError("none")));
  v1::GetCompressedSequenceRequest request;
  v1::GetCompressedSequenceResponse response;
  request.set_id(kId);
  EXPECT_THAT(GetCompressedSequence(mock.context, request, &response),
              HasStatus(absl::StatusCode::kNotFound, "none"));
}

}  // namespace
}  // namespace pleat
