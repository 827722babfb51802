#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <ctime>
#include <nlohmann/json.hpp>

#include "absl/strings/strip.h"
#include "client/run_pleat.h"
#include "pleat/identity/token_registry.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class TokenVerbTest : public testing::Test {
 protected:
  Outcome Run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "token");
    return RunPleat(arguments);
  }
  // The text of a token that is good for a day.
  std::string Create(const std::string& name, const std::string& scopes) {
    const Outcome outcome =
        Run({"create", data_, "--name", name, "--scopes", scopes, "--days", "1"});
    EXPECT_EQ(outcome.code, ExitCode::kOk) << outcome.err;
    return std::string(absl::StripSuffix(outcome.out, "\n"));
  }
  absl::Status Authenticate(const std::string& text, int64_t now) {
    const auto registry =
        TokenRegistry::Open({.path = data_ + "/tokens.json", .clock = [now] { return now; }});
    return (*registry)->Authenticate(text).status();
  }

  TemporaryFolder folder_;
  const std::string data_ = folder_.File("data");  // made by the first token
  const int64_t now_ = std::time(nullptr);
};

TEST_F(TokenVerbTest, WhatIsCreatedIsGoodForItsTimeAndUntilItIsRevoked) {
  const std::string text = Create("render farm", "read,pose");
  EXPECT_THAT(Authenticate(text, now_), IsOk());
  EXPECT_THAT(Authenticate(text, now_ + 25 * 3600),
              HasStatus(absl::StatusCode::kUnauthenticated, HasSubstr("expired")));
  const Outcome list = Run({"list", data_});
  EXPECT_THAT(list.out, AllOf(HasSubstr("render farm"), HasSubstr("read,pose"), HasSubstr("good")));
  const std::string id = text.substr(6, 16), secret = text.substr(23);
  EXPECT_THAT(list.out, AllOf(HasSubstr(id), Not(HasSubstr(secret))));
  EXPECT_EQ(Run({"revoke", data_, id.substr(0, 6)}).out, "revoked " + id + "\n");
  EXPECT_THAT(Authenticate(text, now_),
              HasStatus(absl::StatusCode::kUnauthenticated, HasSubstr("revoked")));
  EXPECT_EQ(json::parse(Run({"list", data_, "--json"}).out)[0]["state"], "revoked");
}

TEST_F(TokenVerbTest, JsonHasIdAndToken) {
  const json made =
      json::parse(Run({"create", data_, "--name", "ci", "--scopes", "read", "--json"}).out);
  EXPECT_THAT(Authenticate(made["token"], now_), IsOk());
  const json list = json::parse(Run({"list", data_, "--json"}).out);
  ASSERT_EQ(list.size(), 1);
  EXPECT_EQ(list[0]["id"], made["id"]);
  EXPECT_EQ(list[0]["expires"], "");
}

TEST_F(TokenVerbTest, ATokenSeesItsProject) {
  Create("x", "read");
  EXPECT_EQ(Run({"create", data_, "--name", "y", "--scopes", "read", "--project", "robots"}).code,
            ExitCode::kOk);
  const json list = json::parse(Run({"list", data_, "--json"}).out);
  EXPECT_EQ(list[0]["project"], "default");
  EXPECT_EQ(list[1]["project"], "robots");
  EXPECT_THAT(Run({"list", data_}).out, HasSubstr("robots"));
  EXPECT_EQ(Run({"create", data_, "--name", "z", "--scopes", "read", "--project", "a/b"}).code,
            ExitCode::kBadInput);
}

TEST_F(TokenVerbTest, MistakesAreNamed) {
  EXPECT_EQ(Run({"create", data_, "--name", "x"}).code, ExitCode::kUsage);
  EXPECT_EQ(Run({"create", data_, "--name", "x", "--scopes", "all"}).code, ExitCode::kBadInput);
  EXPECT_EQ(Run({"create", data_, "--name", "a\nb", "--scopes", "read"}).code, ExitCode::kBadInput);
  Create("x", "read");
  EXPECT_EQ(Run({"revoke", data_}).code, ExitCode::kUsage);
  EXPECT_EQ(Run({"revoke", data_, "zzz"}).code, ExitCode::kNotFound);
  EXPECT_EQ(Run({"destroy", data_}).code, ExitCode::kUsage);
}

}  // namespace
}  // namespace pleat
