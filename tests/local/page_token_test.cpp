#include "page_token.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

TEST(PageToken, SaysWhereThePageBegins) {
  EXPECT_EQ(ParsePageToken(EntryKind::kJob, "").value(), 0);
  for (const EntryKind kind : kEntryKinds) {
    for (const int64_t position : {int64_t{1}, int64_t{500}, std::numeric_limits<int64_t>::max()}) {
      EXPECT_EQ(ParsePageToken(kind, MakePageToken(kind, position)).value(), position);
    }
  }
}

TEST(PageToken, WhatTheListDidNotGiveIsRefused) {
  const std::string good = MakePageToken(EntryKind::kJob, 12);
  const std::string old_tokens[] = {"job-00112233aabbccdd", std::string(64, 'a')};
  for (const std::string& token :
       {old_tokens[0], old_tokens[1], good.substr(1), good + "A", good + "=", std::string("12"),
        std::string(1000, 'x'), MakePageToken(EntryKind::kModel, 12),
        MakePageToken(EntryKind::kJob, 0), MakePageToken(EntryKind::kJob, -1),
        std::string("\0", 1)}) {
    EXPECT_THAT(ParsePageToken(EntryKind::kJob, token),
                HasStatus(absl::StatusCode::kInvalidArgument,
                          HasSubstr("page_token was not given by this list of jobs")))
        << token;
  }
}

TEST(PageToken, EveryTruncationIsRefused) {
  const std::string good = MakePageToken(EntryKind::kSequence, 123456);
  for (size_t size = 1; size < good.size(); ++size) {
    const auto position = ParsePageToken(EntryKind::kSequence, good.substr(0, size));
    // A token that is cut between two digits is a good one, of an earlier place.
    if (!position.ok()) continue;
    EXPECT_EQ(MakePageToken(EntryKind::kSequence, *position).size(), size);
  }
}

}  // namespace
}  // namespace pleat
