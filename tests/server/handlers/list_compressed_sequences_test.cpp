#include "server/handlers/handler_checks.h"

namespace pleat {
namespace {

TEST(ListCompressedSequences, GivesAllOfThemInPages) {
  MockContext mock;
  EXPECT_CALL(mock.compressed_sequences, List)
      .WillRepeatedly(testing::Return(FiveInfos<CompressedSequenceInfo>()));
  ExpectPages<v1::ListCompressedSequencesRequest, v1::ListCompressedSequencesResponse>(
      [&](const auto& request, auto* response) {
        return ListCompressedSequences(mock.context, request, response);
      },
      [](const v1::ListCompressedSequencesResponse& response) {
        std::vector<std::string> ids;
        for (const auto& item : response.compressed_sequences()) ids.push_back(item.id());
        return ids;
      });
}

TEST(ListCompressedSequences, PassesOnWhyItCannot) {
  MockContext mock;
  EXPECT_CALL(mock.compressed_sequences, List)
      .WillOnce(testing::Return(absl::DataLossError("damaged row")));
  v1::ListCompressedSequencesResponse response;
  EXPECT_THAT(ListCompressedSequences(mock.context, {}, &response),
              HasStatus(absl::StatusCode::kDataLoss, "damaged row"));
}

}  // namespace
}  // namespace pleat
