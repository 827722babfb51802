#include "server/handlers/handler_checks.h"

namespace pleat {
namespace {

TEST(ListModels, GivesAllOfThemInPages) {
  MockContext mock;
  EXPECT_CALL(mock.models, List).WillRepeatedly(testing::Return(FiveInfos<ModelInfo>()));
  ExpectPages<v1::ListModelsRequest, v1::ListModelsResponse>(
      [&](const auto& request, auto* response) {
        return ListModels(mock.context, request, response);
      },
      [](const v1::ListModelsResponse& response) {
        std::vector<std::string> ids;
        for (const auto& item : response.models()) ids.push_back(item.id());
        return ids;
      });
}

TEST(ListModels, PassesOnWhyItCannot) {
  MockContext mock;
  EXPECT_CALL(mock.models, List).WillOnce(testing::Return(absl::DataLossError("damaged row")));
  v1::ListModelsResponse response;
  EXPECT_THAT(ListModels(mock.context, {}, &response),
              HasStatus(absl::StatusCode::kDataLoss, "damaged row"));
}

}  // namespace
}  // namespace pleat
