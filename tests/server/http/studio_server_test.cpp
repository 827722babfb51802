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

// The same with tokens.
class StudioTokensTest : public StudioTest {
 protected:
  StudioTokensTest() : StudioTest(Options()) {}
  GrpcServerOptions Options() {
    reader_ = tokens().Add("reader", "read").text;
    trainer_ = tokens().Add("trainer", "read,train,pose").text;
    return {.tokens = tokens().registry()};
  }
  static TestTokens& tokens() {
    static TestTokens& tokens = *new TestTokens;
    return tokens;
  }
  int Status(const std::string& method, const std::string& target, const std::string& token) {
    return HttpClient::StatusOf(Ask(method, target, "{}", {"Authorization: Bearer " + token}));
  }
  std::string reader_, trainer_;
};

TEST_F(StudioTokensTest, TokensAreThoseOfTheServer) {
  for (const char* target :
       {"/rpc/ModelService/ListModels", "/studio/uploads", "/studio/example"}) {
    EXPECT_EQ(HttpClient::StatusOf(Ask("POST", target, "{}")), 401) << target;
    EXPECT_EQ(Status("POST", target, "wrong"), 401) << target;
    EXPECT_EQ(Status("POST", target, "bad\xff\x01token"), 401 - 1)
        << target;  // no header may have it
  }
  EXPECT_EQ(Status("POST", "/rpc/ModelService/ListModels", reader_), 200);
  EXPECT_EQ(Status("POST", "/studio/uploads", reader_), 403);
  EXPECT_EQ(Status("POST", "/studio/uploads", trainer_), 200);
  EXPECT_EQ(HttpClient::StatusOf(Ask("GET", "/")), 200);  // the page itself is no secret
}

}  // namespace
}  // namespace pleat
