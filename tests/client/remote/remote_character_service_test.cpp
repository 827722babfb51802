#include "pleat/remote/remote_character_service.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/remote/scripted_server.h"
#include "pleat/identity/token.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

class RemoteTokenTest : public testing::Test {
 protected:
  const std::string token_ = MakeToken("ci", ScopeSet::All(), 0, {}).text;
};

TEST_F(RemoteTokenTest, EveryCallShowsTheToken) {
  ScriptedServer server;
  std::vector<std::string> shown;
  EXPECT_CALL(server.models, DeleteModel).WillOnce([&](grpc::ServerContext* call, auto*, auto*) {
    const auto it = call->client_metadata().find("authorization");
    if (it != call->client_metadata().end())
      shown.emplace_back(it->second.data(), it->second.size());
    return grpc::Status::OK;
  });
  EXPECT_CALL(server.poses, LiveSession).WillOnce([&](grpc::ServerContext* call, LiveStream*) {
    const auto it = call->client_metadata().find("authorization");
    if (it != call->client_metadata().end())
      shown.emplace_back(it->second.data(), it->second.size());
    return grpc::Status(grpc::StatusCode::PERMISSION_DENIED, "seen enough");
  });
  const auto client = server.Connect({.token = token_});
  EXPECT_THAT(client->models().Delete("m"), IsOk());
  ClipQuery character;
  character.model_id = "m";
  EXPECT_THAT(client->poses().OpenLiveSession(character),
              HasStatus(absl::StatusCode::kPermissionDenied, "seen enough"));
  EXPECT_EQ(shown, std::vector<std::string>(2, "Bearer " + token_));
}

TEST_F(RemoteTokenTest, ATokenLeavesTheMachineOnlyEncrypted) {
  EXPECT_THAT(RemoteCharacterService::Connect("studio.example:7320", {.token = token_}),
              HasStatus(absl::StatusCode::kFailedPrecondition, HasSubstr("use TLS")));
}

TEST_F(RemoteTokenTest, ATextThatIsNoTokenIsNotSent) {
  for (const std::string& text : {token_ + "\n", std::string("secret"), token_.substr(1)}) {
    EXPECT_THAT(RemoteCharacterService::Connect("127.0.0.1:1", {.token = text}),
                HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("pleat_ID_SECRET")));
  }
}

TEST(CheckHealthTest, TheErrorsOfTheCallAreThoseOfTheCheck) {
  ScriptedServer server;  // without a health service
  EXPECT_THAT(server.Open()->CheckHealth().status(),
              HasStatus(absl::StatusCode::kUnimplemented, HasSubstr("")));
}

}  // namespace
}  // namespace pleat
