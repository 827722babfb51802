#include "server/http/studio_fixture.h"

namespace pleat {
namespace {

using testing::HasSubstr;

using RpcRoutesTest = StudioTest;

TEST_F(RpcRoutesTest, ATrainingIsWatchedToItsEnd) {
  const nlohmann::json take = UploadTube();
  const nlohmann::json job =
      Call("JobService/CreateTrainingJob", {{"sequenceIds", {take["sequence"]["id"]}}});
  const std::string lines = Dechunk(HttpClient::BodyOf(
      Ask("POST", "/rpc/JobService/WatchJob", nlohmann::json{{"id", job["job"]["id"]}}.dump())));
  EXPECT_THAT(lines, HasSubstr("JOB_STATE_SUCCEEDED"));
  EXPECT_EQ(Call("ModelService/ListModels")["models"].size(), 1u);
}

TEST_F(RpcRoutesTest, ErrorsOfCallsAreThoseOfTheService) {
  const std::string response =
      Ask("POST", "/rpc/ModelService/GetModel", R"({"id":")" + std::string(64, 'a') + "\"}");
  EXPECT_EQ(HttpClient::StatusOf(response), 404);
  EXPECT_THAT(response, HasSubstr("NOT_FOUND"));
  EXPECT_EQ(HttpClient::StatusOf(Ask("POST", "/rpc/ModelService/Nothing", "{}")), 404);
  EXPECT_EQ(HttpClient::StatusOf(Ask("POST", "/rpc/SequenceService/UploadSequence", "{}")), 501);
  EXPECT_EQ(HttpClient::StatusOf(Ask("GET", "/rpc/ModelService/ListModels")), 501);
  EXPECT_EQ(HttpClient::StatusOf(Ask("POST", "/", "x")), 501);
  EXPECT_EQ(HttpClient::StatusOf(Ask("GET", "/studio/nothing")), 404);
}

}  // namespace
}  // namespace pleat
