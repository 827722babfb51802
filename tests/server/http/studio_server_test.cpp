#include <set>

#include "pleat/v1/model_service.grpc.pb.h"
#include "server/http/studio_fixture.h"
#include "support/token_files.h"

namespace pleat {
namespace {

using StudioServerTest = StudioTest;

TEST_F(StudioServerTest, AForeignPageCannotDriveIt) {
  const auto ask = [&](const std::string& target, const std::vector<std::string>& headers) {
    return HttpClient::StatusOf(HttpClient::Ask(studio_->address(), "POST", target, headers, "{}"));
  };
  EXPECT_EQ(ask("/rpc/ModelService/ListModels", {}), 403);
  EXPECT_EQ(
      ask("/rpc/ModelService/ListModels", {"X-Pleat-Studio: 1", "Origin: http://evil.example"}),
      403);
  EXPECT_EQ(ask("/rpc/ModelService/ListModels", {"X-Pleat-Studio: 1", "Host: evil.example"}), 403);
  EXPECT_EQ(ask("/rpc/ModelService/ListModels", {"X-Pleat-Studio: 1"}), 200);
  EXPECT_EQ(HttpClient::StatusOf(HttpClient::Ask(studio_->address(), "GET", "/")), 200);
}

// A page beside the fixture's own that shares some content with whoever has no token.
class SharedPage {
 public:
  SharedPage(RunningService* running, std::set<std::string> ids)
      : studio_(StudioServer::Start({.listen = "127.0.0.1:0",
                                     .scratch_dir = running->data_dir() + "/shared-uploads",
                                     .version = "test",
                                     .shared = std::move(ids)},
                                    &running->server())
                    .value()) {}
  std::string Ask(const std::string& method, const std::string& target, const std::string& body,
                  const std::string& token = "") {
    std::vector<std::string> headers = {"X-Pleat-Studio: 1"};
    if (!token.empty()) headers.push_back("Authorization: Bearer " + token);
    return HttpClient::Ask(studio_->address(), method, target, headers, body);
  }
  int Status(const std::string& rpc, const std::string& body, const std::string& token = "") {
    return HttpClient::StatusOf(Ask("POST", "/rpc/" + rpc, body, token));
  }

 private:
  const std::unique_ptr<StudioServer> studio_;
};

TEST_F(StudioServerTest, ALinkShowsOneCharacterAndChangesNothing) {
  const std::string other = UploadTube(4)["sequence"]["id"];
  const std::string take = UploadTube(5)["sequence"]["id"];
  const std::string model = running_.TrainModel();
  SharedPage page(&running_, {model, take});
  const nlohmann::json about =
      nlohmann::json::parse(HttpClient::BodyOf(page.Ask("GET", "/studio/about", "")));
  EXPECT_EQ(about["shared"].size(), 2u);
  const nlohmann::json takes = nlohmann::json::parse(
      HttpClient::BodyOf(page.Ask("POST", "/rpc/SequenceService/ListSequences", "{}")));
  ASSERT_EQ(takes["sequences"].size(), 1u);
  EXPECT_EQ(takes["sequences"][0]["id"], take);
  const auto id = [](const std::string& of) { return nlohmann::json{{"id", of}}.dump(); };
  EXPECT_EQ(page.Status("ModelService/GetModel", id(model)), 200);
  EXPECT_EQ(page.Status("SequenceService/GetSequence", id(other)), 404);
  EXPECT_EQ(page.Status("SequenceService/DownloadSequence", id(other)), 404);
  EXPECT_EQ(page.Status("ModelService/DeleteModel", id(model)), 403);
  EXPECT_EQ(
      page.Status("JobService/CreateTrainingJob", nlohmann::json{{"sequenceIds", {take}}}.dump()),
      403);
  EXPECT_EQ(HttpClient::StatusOf(page.Ask("POST", "/studio/uploads", "")), 403);
  EXPECT_EQ(HttpClient::StatusOf(page.Ask("POST", "/studio/example", "")), 403);
  EXPECT_EQ(HttpClient::StatusOf(page.Ask("GET", "/studio/models/" + model + "/page", "")), 200);
  // No token is known here, so none opens more.
  EXPECT_EQ(page.Status("ModelService/DeleteModel", id(model), "pleat_made_up"), 403);
  EXPECT_EQ(page.Status("SequenceService/GetSequence", id(other), "pleat_made_up"), 404);
}

// Whoever comes over the network may say what it wants of itself.
TEST_F(StudioServerTest, NobodyOutsideCanSpeakAsTheServerItself) {
  const std::string body = "{}";
  EXPECT_EQ(HttpClient::StatusOf(Ask("POST", "/rpc/ModelService/ListModels", body,
                                     {"x-pleat-shared: nothing", "x-pleat-inside: guessed"})),
            200);
  auto stub = v1::ModelService::NewStub(running_.server().InProcessChannel());
  grpc::ClientContext context;
  context.AddMetadata("x-pleat-shared", std::string(64, 'a'));
  context.AddMetadata("x-pleat-inside", std::string(64, '0'));
  UploadTube();
  const std::string model = running_.TrainModel();
  v1::ListModelsResponse response;
  EXPECT_TRUE(stub->ListModels(&context, {}, &response).ok());
  EXPECT_EQ(response.models_size(), 1) << "a share was taken from outside";
}

// The same with tokens.
struct KnownTokens {
  TestTokens store;
  std::string reader = store.Add("reader", "read").text;
  std::string trainer = store.Add("trainer", "read,train,pose").text;
};

class StudioTokensTest : public StudioTest {
 protected:
  StudioTokensTest() : StudioTest({.tokens = tokens().store.registry()}) {}
  static KnownTokens& tokens() {
    static KnownTokens& tokens = *new KnownTokens;
    return tokens;
  }
  int Status(const std::string& method, const std::string& target, const std::string& token) {
    return HttpClient::StatusOf(Ask(method, target, "{}", {"Authorization: Bearer " + token}));
  }
};

TEST_F(StudioTokensTest, TokensAreThoseOfTheServer) {
  for (const char* target :
       {"/rpc/ModelService/ListModels", "/studio/uploads", "/studio/example"}) {
    EXPECT_EQ(HttpClient::StatusOf(Ask("POST", target, "{}")), 401) << target;
    EXPECT_EQ(Status("POST", target, "wrong"), 401) << target;
    EXPECT_EQ(Status("POST", target, "bad\xff\x01token"), 400) << target;  // no header may have it
  }
  EXPECT_EQ(Status("POST", "/rpc/ModelService/ListModels", tokens().reader), 200);
  EXPECT_EQ(Status("POST", "/studio/uploads", tokens().reader), 403);
  EXPECT_EQ(Status("POST", "/studio/uploads", tokens().trainer), 200);
  EXPECT_EQ(HttpClient::StatusOf(Ask("GET", "/")), 200);  // the page itself is no secret
}

TEST_F(StudioTokensTest, ALinkNeedsNoTokenAndATokenShowsMore) {
  SharedPage page(&running_, {std::string(64, 'a')});
  EXPECT_EQ(page.Status("ModelService/ListModels", "{}"), 200);
  EXPECT_EQ(HttpClient::StatusOf(page.Ask("POST", "/studio/uploads", "")), 403);
  EXPECT_EQ(page.Status("ModelService/ListModels", "{}", "wrong"), 401);
  EXPECT_EQ(HttpClient::StatusOf(page.Ask("POST", "/studio/uploads", "", tokens().trainer)), 200);
}

}  // namespace
}  // namespace pleat
