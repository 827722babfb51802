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

TEST_F(RpcRoutesTest, ADownloadIsOfferedAsAFile) {
  const nlohmann::json take = UploadTube();
  const std::string body = nlohmann::json{{"id", take["sequence"]["id"]}}.dump();
  const std::string target = "/rpc/SequenceService/DownloadSequence";
  EXPECT_THAT(Ask("POST", target + "?save=my%20tube.pseq", body),
              HasSubstr("attachment; filename*=UTF-8''my%20tube.pseq"));
  EXPECT_THAT(Ask("POST", target, body), testing::Not(HasSubstr("attachment")));
}

TEST_F(RpcRoutesTest, WhatIsNoRequestIsRefusedInWords) {
  for (const char* body : {"", "[]", "{", "{\"id\": 5}", "{\"nothing\": 1}", "\xff"}) {
    const std::string response = Ask("POST", "/rpc/ModelService/GetModel", body);
    EXPECT_EQ(HttpClient::StatusOf(response), 400) << body;
    EXPECT_THAT(response, HasSubstr("INVALID_ARGUMENT")) << body;
  }
}

// Whatever a page asks for, the answer is one of the service or of the route, never a fault of the
// server.
TEST_F(RpcRoutesTest, EveryRpcAnswersAnEmptyRequest) {
  for (const char* rpc : {"SequenceService/QueryUpload",
                          "SequenceService/GetSequence",
                          "SequenceService/ListSequences",
                          "SequenceService/DownloadSequence",
                          "SequenceService/DeleteSequence",
                          "SequenceService/PinSequence",
                          "SequenceService/DeleteUpload",
                          "JobService/CreateTrainingJob",
                          "JobService/CreateCompressionJob",
                          "JobService/GetJob",
                          "JobService/ListJobs",
                          "JobService/WatchJob",
                          "JobService/CancelJob",
                          "JobService/DeleteJob",
                          "ModelService/GetModel",
                          "ModelService/ListModels",
                          "ModelService/DeleteModel",
                          "ModelService/PinModel",
                          "ModelService/DownloadModel",
                          "CompressedSequenceService/GetCompressedSequence",
                          "CompressedSequenceService/ListCompressedSequences",
                          "CompressedSequenceService/DecodeFrames",
                          "PoseService/GetStreamHeader",
                          "PoseService/EvaluatePose",
                          "PoseService/EvaluateClip"}) {
    const std::string response = Ask("POST", "/rpc/" + std::string(rpc), "{}");
    const int status = HttpClient::StatusOf(response);
    EXPECT_TRUE(status == 200 || status == 400 || status == 404) << rpc << ": " << response;
  }
}

}  // namespace
}  // namespace pleat
