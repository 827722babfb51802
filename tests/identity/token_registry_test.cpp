#include "pleat/identity/token_registry.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "pleat/base/file.h"
#include "pleat/identity/token_file.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

class TokenRegistryTest : public testing::Test {
 protected:
  void Open() {
    registry_ =
        TokenRegistry::Open(
            {.path = path_,
             .clock = [this] { return now_; },
             .on_problem = [this](const std::string& problem) { problems_.push_back(problem); }})
            .value();
  }
  NewToken Add(const std::string& name, std::optional<int64_t> expires = {}) {
    const NewToken made = MakeToken(name, ScopeSet::All(), now_, expires);
    EXPECT_THAT(ChangeTokens(path_,
                             [&](std::vector<Token>* tokens) {
                               tokens->push_back(made.token);
                               return absl::OkStatus();
                             }),
                IsOk());
    return made;
  }
  void Revoke(const std::string& id) {
    EXPECT_THAT(ChangeTokens(path_,
                             [&](std::vector<Token>* tokens) {
                               for (Token& token : *tokens) {
                                 if (token.id == id) token.revoked = now_;
                               }
                               return absl::OkStatus();
                             }),
                IsOk());
  }

  TemporaryFolder folder_;
  const std::string path_ = TokenPath(folder_.path());
  int64_t now_ = 1000;
  std::vector<std::string> problems_;
  std::unique_ptr<TokenRegistry> registry_;
};

TEST_F(TokenRegistryTest, KnowsTheOwnerOfAToken) {
  const NewToken made = Add("farm");
  Open();
  PLEAT_ASSERT_OK_AND_ASSIGN(const Token token, registry_->Authenticate(made.text));
  EXPECT_EQ(token.name, "farm");
  EXPECT_EQ(registry_->NameOf(token.id), "farm");
  EXPECT_EQ(registry_->NameOf("0000000000000000"), "");
  EXPECT_TRUE(registry_->IsStillGood(token.id));
  EXPECT_FALSE(registry_->IsStillGood("0000000000000000"));
}

TEST_F(TokenRegistryTest, RefusesEverythingElse) {
  const NewToken made = Add("farm");
  Open();
  std::string other_secret = made.text;
  other_secret.back() = other_secret.back() == '0' ? '1' : '0';
  EXPECT_THAT(registry_->Authenticate(other_secret),
              HasStatus(absl::StatusCode::kUnauthenticated, HasSubstr("does not know")));
  EXPECT_THAT(registry_->Authenticate(MakeToken("stranger", ScopeSet::All(), 0, {}).text),
              HasStatus(absl::StatusCode::kUnauthenticated, HasSubstr("does not know")));
  EXPECT_THAT(registry_->Authenticate(""),
              HasStatus(absl::StatusCode::kUnauthenticated, HasSubstr("pleat token create")));
}

TEST_F(TokenRegistryTest, ATokenThatExpiresIsRefusedFromThatSecondOn) {
  const NewToken made = Add("guest", now_ + 10);
  Open();
  now_ += 9;
  EXPECT_THAT(registry_->Authenticate(made.text), IsOk());
  now_ += 1;
  EXPECT_THAT(registry_->Authenticate(made.text),
              HasStatus(absl::StatusCode::kUnauthenticated, HasSubstr("'guest' has expired")));
  EXPECT_FALSE(registry_->IsStillGood(made.token.id));
}

TEST_F(TokenRegistryTest, SeesEachChangeOfTheFileAtOnce) {
  Open();
  EXPECT_FALSE(registry_->required());
  const NewToken made = Add("farm");
  EXPECT_TRUE(registry_->required());
  EXPECT_THAT(registry_->Authenticate(made.text), IsOk());
  Revoke(made.token.id);
  EXPECT_THAT(registry_->Authenticate(made.text),
              HasStatus(absl::StatusCode::kUnauthenticated, HasSubstr("was revoked")));
  EXPECT_FALSE(registry_->IsStillGood(made.token.id));
}

TEST_F(TokenRegistryTest, AFileThatVanishesOpensNoDoor) {
  const NewToken made = Add("farm");
  Open();
  std::filesystem::remove(path_);
  EXPECT_TRUE(registry_->required());
  EXPECT_THAT(registry_->Authenticate(made.text),
              HasStatus(absl::StatusCode::kUnauthenticated, HasSubstr("does not know")));
}

TEST_F(TokenRegistryTest, AFileThatCannotBeReadLeavesTheTokensAndIsSaidOnce) {
  const NewToken made = Add("farm");
  Open();
  ASSERT_THAT(WriteFile(path_, "{}"), IsOk());
  EXPECT_THAT(registry_->Authenticate(made.text), IsOk());
  EXPECT_THAT(registry_->Authenticate(made.text), IsOk());
  ASSERT_EQ(problems_.size(), 1);
  EXPECT_THAT(problems_[0], HasSubstr("stay as they were"));
}

TEST_F(TokenRegistryTest, DoesNotOpenWithAFileThatCannotBeRead) {
  ASSERT_THAT(WriteFile(path_, "{}"), IsOk());
  EXPECT_THAT(TokenRegistry::Open({.path = path_, .clock = [] { return int64_t{0}; }}),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("version")));
}

}  // namespace
}  // namespace pleat
