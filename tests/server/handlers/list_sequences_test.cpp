#include "server/handlers/handler_checks.h"

namespace pleat {
namespace {

TEST(ListSequences, GivesAllOfThemInPages) {
  MockContext mock;
  EXPECT_CALL(mock.sequences, List).WillRepeatedly(testing::Return(FiveInfos<SequenceInfo>()));
  ExpectPages<v1::ListSequencesRequest, v1::ListSequencesResponse>(
      [&](const auto& request, auto* response) {
        return ListSequences(mock.context, request, response);
      },
      [](const v1::ListSequencesResponse& response) {
        std::vector<std::string> ids;
        for (const auto& item : response.sequences()) ids.push_back(item.id());
        return ids;
      });
}

TEST(ListSequences, PassesOnWhyItCannot) {
  MockContext mock;
  EXPECT_CALL(mock.sequences, List).WillOnce(testing::Return(absl::DataLossError("damaged row")));
  v1::ListSequencesResponse response;
  EXPECT_THAT(ListSequences(mock.context, {}, &response),
              HasStatus(absl::StatusCode::kDataLoss, "damaged row"));
}

}  // namespace
}  // namespace pleat
