#include "pleat/identity/token_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <thread>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "pleat/base/file.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

std::vector<Token> TwoTokens() {
  ScopeSet read;
  read.Add(Scope::kRead);
  Token farm = MakeToken("farm", read, 100, 200).token;
  farm.revoked = 150;
  return {farm, MakeToken("Zoë", ScopeSet::All(), 300, {}, "robots").token};
}

absl::Status Append(const std::string& path, const Token& token) {
  return ChangeTokens(path, [&](std::vector<Token>* tokens) {
    tokens->push_back(token);
    return absl::OkStatus();
  });
}

TEST(TokenFileTest, WhatIsWrittenIsReadBack) {
  const std::vector<Token> tokens = TwoTokens();
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::vector<Token> read, ParseTokens(FormatTokens(tokens)));
  ASSERT_EQ(read.size(), 2);
  for (size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(read[i].id, tokens[i].id);
    EXPECT_EQ(read[i].name, tokens[i].name);
    EXPECT_EQ(read[i].secret_hash, tokens[i].secret_hash);
    EXPECT_EQ(read[i].scopes, tokens[i].scopes);
    EXPECT_EQ(read[i].project, tokens[i].project);
    EXPECT_EQ(read[i].created, tokens[i].created);
    EXPECT_EQ(read[i].expires, tokens[i].expires);
    EXPECT_EQ(read[i].revoked, tokens[i].revoked);
  }
}

TEST(TokenFileTest, OneWrongTokenRefusesTheFile) {
  const std::vector<Token> tokens = TwoTokens();
  const std::string good = FormatTokens(tokens);
  const std::string where = absl::StrCat("token ", tokens[0].id);
  const struct {
    std::string from, to, word;
  } changes[] = {{"\"version\": 1", "\"version\": 2", "version"},
                 {"\"tokens\"", "\"token\"", "no list"},
                 {tokens[0].id, "5d0f", "16"},
                 {tokens[0].secret_hash, std::string(64, 'g'), "64 hexadecimal"},
                 {"\"read\"", "\"all\"", where},
                 {"\"farm\"", "\"\"", where},
                 {"\"robots\"", "\"../etc\"", "project"},
                 {"\"robots\"", "7", "project"},
                 {": 200", ": \"soon\"", "expires"},
                 {": 150", ": 1.5", "revoked"}};
  for (const auto& change : changes) {
    const std::string bad = absl::StrReplaceAll(good, {{change.from, change.to}});
    ASSERT_NE(bad, good) << change.from;
    EXPECT_THAT(ParseTokens(bad),
                HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr(change.word)));
  }
  for (size_t length = 0; length + 2 < good.size(); length += 7) {
    EXPECT_THAT(ParseTokens(good.substr(0, length)),
                HasStatus(absl::StatusCode::kInvalidArgument, testing::HasSubstr("malformed")));
  }
}

// Files of versions without projects have no such field, and neither has the default project.
TEST(TokenFileTest, ATokenThatNamesNoProjectIsOfTheDefaultOne) {
  const std::vector<Token> tokens = TwoTokens();
  const std::string text = FormatTokens({tokens[0]});
  EXPECT_THAT(text, testing::Not(HasSubstr("project")));
  EXPECT_EQ(ParseTokens(text)->at(0).project, kDefaultProject);
}

TEST(TokenFileTest, AMissingFileHoldsNoTokens) {
  TemporaryFolder folder;
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::vector<Token> tokens, ReadTokens(TokenPath(folder.path())));
  EXPECT_TRUE(tokens.empty());
}

TEST(TokenFileTest, OnlyItsOwnerCanReadIt) {
  TemporaryFolder folder;
  const std::string path = TokenPath(folder.path());
  ASSERT_THAT(Append(path, TwoTokens()[0]), IsOk());
  struct stat info {};
  ASSERT_EQ(stat(path.c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 0777, 0600);
}

TEST(TokenFileTest, AnErrorLeavesTheFileAsItIs) {
  TemporaryFolder folder;
  const std::string path = TokenPath(folder.path());
  ASSERT_THAT(Append(path, TwoTokens()[0]), IsOk());
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::string before, ReadFile(path));
  EXPECT_THAT(ChangeTokens(path,
                           [](std::vector<Token>* tokens) {
                             tokens->clear();
                             return absl::NotFoundError("no such token");
                           }),
              HasStatus(absl::StatusCode::kNotFound, "no such token"));
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::string after, ReadFile(path));
  EXPECT_EQ(after, before);
  ASSERT_THAT(WriteFile(path, "{"), IsOk());
  EXPECT_THAT(Append(path, TwoTokens()[0]),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr(path)));
}

TEST(TokenFileTest, ChangesAtTheSameTimeAreAllKept) {
  TemporaryFolder folder;
  const std::string path = TokenPath(folder.path());
  std::vector<std::thread> threads;
  for (int i = 0; i < 8; ++i) {
    threads.emplace_back([&path, i] {
      EXPECT_THAT(Append(path, MakeToken(absl::StrCat("token ", i), ScopeSet::All(), i, {}).token),
                  IsOk());
    });
  }
  for (std::thread& thread : threads) thread.join();
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::vector<Token> tokens, ReadTokens(path));
  EXPECT_EQ(tokens.size(), 8);
}

}  // namespace
}  // namespace pleat
