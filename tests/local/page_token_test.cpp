#include "page_token.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

const PageTokens& Tokens() {
  static const PageTokens tokens("a secret", "robots");
  return tokens;
}

TEST(PageToken, SaysWhereThePageBegins) {
  EXPECT_EQ(Tokens().Parse(EntryKind::kJob, "").value(), 0);
  for (const EntryKind kind : kEntryKinds) {
    for (const int64_t position : {int64_t{1}, int64_t{500}, std::numeric_limits<int64_t>::max()}) {
      EXPECT_EQ(Tokens().Parse(kind, Tokens().Make(kind, position)).value(), position);
    }
  }
}

TEST(PageToken, WhatTheListDidNotGiveIsRefused) {
  const std::string good = Tokens().Make(EntryKind::kJob, 12);
  const std::string old_tokens[] = {"job-00112233aabbccdd", std::string(64, 'a'), "MjpqOjEy"};
  for (const std::string& token :
       {old_tokens[0], old_tokens[1], old_tokens[2], good.substr(1), good + "A", good + "=",
        std::string("12"), std::string(1000, 'x'), Tokens().Make(EntryKind::kModel, 12),
        Tokens().Make(EntryKind::kJob, 0), Tokens().Make(EntryKind::kJob, -1),
        PageTokens("a secret", "ghosts").Make(EntryKind::kJob, 12),
        PageTokens("another", "robots").Make(EntryKind::kJob, 12), std::string("\0", 1)}) {
    EXPECT_THAT(Tokens().Parse(EntryKind::kJob, token),
                HasStatus(absl::StatusCode::kInvalidArgument,
                          HasSubstr("page_token was not given by this list of jobs")))
        << token;
  }
}

TEST(PageToken, EveryChangeAndEveryTruncationIsRefused) {
  const std::string good = Tokens().Make(EntryKind::kSequence, 123456);
  for (size_t i = 0; i < good.size(); ++i) {
    EXPECT_FALSE(Tokens().Parse(EntryKind::kSequence, good.substr(0, i)).ok() && i > 0);
    std::string changed = good;
    changed[i] = changed[i] == 'A' ? 'B' : 'A';
    EXPECT_FALSE(Tokens().Parse(EntryKind::kSequence, changed).ok()) << i;
  }
}

// Neighbors have nothing in common, so nobody can count what lies between them.
TEST(PageToken, TellsNothingAboutThePosition) {
  const std::string one = Tokens().Make(EntryKind::kSequence, 1000);
  const std::string next = Tokens().Make(EntryKind::kSequence, 1001);
  int num_equal = 0;
  for (size_t i = 0; i < one.size(); ++i) num_equal += one[i] == next[i];
  EXPECT_LT(num_equal, 6);
}

}  // namespace
}  // namespace pleat
