#include "server/handlers/handler_checks.h"

namespace pleat {
namespace {

TEST(ListJobs, GivesAllOfThemInPages) {
  MockContext mock;
  EXPECT_CALL(mock.jobs, List).WillRepeatedly(testing::Return(FiveInfos<JobInfo>()));
  ExpectPages<v1::ListJobsRequest, v1::ListJobsResponse>(
      [&](const auto& request, auto* response) {
        return ListJobs(mock.context, request, response);
      },
      [](const v1::ListJobsResponse& response) {
        std::vector<std::string> ids;
        for (const auto& item : response.jobs()) ids.push_back(item.id());
        return ids;
      });
}

TEST(ListJobs, PassesOnWhyItCannot) {
  MockContext mock;
  EXPECT_CALL(mock.jobs, List).WillOnce(testing::Return(absl::DataLossError("damaged row")));
  v1::ListJobsResponse response;
  EXPECT_THAT(ListJobs(mock.context, {}, &response),
              HasStatus(absl::StatusCode::kDataLoss, "damaged row"));
}

}  // namespace
}  // namespace pleat
