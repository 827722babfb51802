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

}  // namespace
}  // namespace pleat
