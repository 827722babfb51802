#include "json_calls.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pleat/v1/job_service.pb.h"
#include "pleat/v1/model_service.pb.h"
#include "support/hostile_bytes.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using testing::_;
using testing::HasSubstr;

TEST(JsonCallsTest, RequestsAndResponsesFollowTheMapping) {
  const auto* method = FindMethod("JobService", "CreateTrainingJob").value();
  EXPECT_EQ(FullName(*method), "/pleat.v1.JobService/CreateTrainingJob");
  const std::string bytes =
      RequestFromJson(*method, R"({"sequenceIds":["a"],"options":{"resolutionPercent":20}})")
          .value();
  v1::CreateTrainingJobRequest request;
  ASSERT_TRUE(request.ParseFromString(bytes));
  EXPECT_EQ(request.sequence_ids(0), "a");
  EXPECT_EQ(request.options().resolution_percent(), 20);
  v1::CreateTrainingJobResponse response;
  response.mutable_job()->set_id("j");
  EXPECT_THAT(ResponseToJson(*method, response.SerializeAsString()).value(),
              HasSubstr(R"("fraction":0)"));
}

TEST(JsonCallsTest, OnlyCallsOfPleatAreThere) {
  EXPECT_THAT(FindMethod("JobService", "Nothing"), HasStatus(absl::StatusCode::kNotFound, _));
  EXPECT_THAT(FindMethod("../JobService", "GetJob"), HasStatus(absl::StatusCode::kNotFound, _));
  EXPECT_THAT(FindMethod("", ""), HasStatus(absl::StatusCode::kNotFound, _));
}

TEST(JsonCallsTest, PiecesOfFilesAreFound) {
  const auto* download = FindMethod("ModelService", "DownloadModel").value();
  EXPECT_TRUE(IsDownload(*download));
  EXPECT_FALSE(IsDownload(*FindMethod("JobService", "WatchJob").value()));
  v1::DownloadModelResponse response;
  response.set_data("abc");
  response.set_size_bytes(7);
  const FilePiece piece = PieceOf(*download, response.SerializeAsString()).value();
  EXPECT_EQ(piece.data, "abc");
  EXPECT_EQ(piece.size_bytes, 7u);
  EXPECT_THAT(PieceOf(*download, "\xff\xff"), HasStatus(absl::StatusCode::kInternal, _));
}

TEST(JsonCallsTest, HostileJsonIsRefusedInWords) {
  const auto* method = FindMethod("JobService", "CreateTrainingJob").value();
  for (const char* bad : {"", "[]", "{", "{\"nothing\":1}", "{\"sequenceIds\":1}",
                          "{\"options\":[]}", "{\"options\":{\"history\":\"x\"}}"}) {
    EXPECT_THAT(RequestFromJson(*method, bad), HasStatus(absl::StatusCode::kInvalidArgument, _))
        << bad;
  }
  // Deep nesting ends with an error and not with the stack.
  EXPECT_FALSE(RequestFromJson(*method, std::string(100'000, '[')).ok());
  EXPECT_FALSE(RequestFromJson(*method, "{\"options\":" + std::string(100'000, '{')).ok());
  const std::string good = R"({"sequenceIds":["a","b"],"options":{"seed":"7","refine":"none"}})";
  ForEachTruncation(good, [&](const auto& part) {
    EXPECT_FALSE(RequestFromJson(*method, std::string(part)).ok());
  });
}

}  // namespace
}  // namespace pleat
