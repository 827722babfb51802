#include "pleat/identity/token.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pleat/base/sha256.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

TEST(TokenTest, TheTextHasTheIdAndASecretOfWhichTheTokenKeepsTheHash) {
  const NewToken made = MakeToken("farm", ScopeSet::All(), 100, 200);
  const std::optional<TokenText> parts = ParseTokenText(made.text);
  ASSERT_TRUE(parts.has_value()) << made.text;
  EXPECT_EQ(parts->id, made.token.id);
  EXPECT_EQ(ToHex(ComputeSha256(parts->secret)), made.token.secret_hash);
  EXPECT_TRUE(SecretFits(made.token, parts->secret));
  EXPECT_FALSE(SecretFits(made.token, made.token.secret_hash)) << "the hash must open nothing";
  EXPECT_NE(MakeToken("farm", ScopeSet::All(), 100, 200).text, made.text);
}

TEST(TokenTest, OtherTextsAreNoTokens) {
  const std::string good = MakeToken("farm", ScopeSet::All(), 0, {}).text;
  EXPECT_TRUE(ParseTokenText(good));
  for (size_t length = 0; length < good.size(); ++length) {
    EXPECT_FALSE(ParseTokenText(good.substr(0, length))) << length;
  }
  EXPECT_FALSE(ParseTokenText(good + "0"));
  for (size_t i = 0; i < good.size(); ++i) {
    for (const char wrong : {'\n', 'G', '-', '\0'}) {
      std::string text = good;
      text[i] = wrong;
      EXPECT_FALSE(ParseTokenText(text)) << i;
    }
  }
}

TEST(TokenTest, IsGoodUntilItExpiresOrIsRevoked) {
  Token token = MakeToken("farm", ScopeSet::All(), 100, 200).token;
  EXPECT_TRUE(IsGood(token, 199));
  EXPECT_FALSE(IsGood(token, 200));
  token.expires.reset();
  EXPECT_TRUE(IsGood(token, 1'000'000'000'000));
  token.revoked = 150;
  EXPECT_FALSE(IsGood(token, 151));
}

TEST(TokenTest, NamesAreTextForLists) {
  EXPECT_THAT(CheckTokenName("Zoë's farm"), IsOk());
  EXPECT_THAT(CheckTokenName(std::string(64, 'x')), IsOk());
  for (const std::string& name : {std::string(), std::string(65, 'x'), std::string("a\nb"),
                                  std::string("a\0b", 3), std::string("\xff")}) {
    EXPECT_THAT(CheckTokenName(name),
                HasStatus(absl::StatusCode::kInvalidArgument, testing::HasSubstr("token")));
  }
}

}  // namespace
}  // namespace pleat
