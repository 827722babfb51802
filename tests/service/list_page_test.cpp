#include "pleat/service/list_page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pleat/service/limits.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(ListPage, ASizeOutOfRangeIsRefused) {
  EXPECT_EQ(MaxItemsOf({}).value(), kMaxPageSize);
  EXPECT_EQ(MaxItemsOf({.size = 1}).value(), 1);
  EXPECT_EQ(MaxItemsOf({.size = kMaxPageSize}).value(), kMaxPageSize);
  for (const int size : {-1, static_cast<int>(kMaxPageSize) + 1}) {
    EXPECT_THAT(MaxItemsOf({.size = size}),
                HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("page_size")));
  }
}

TEST(ListPage, AllPagesAreReadInTheirOrder) {
  std::vector<std::string> tokens;
  const auto read = [&](const PageRequest& request) -> absl::StatusOr<Page<int>> {
    tokens.push_back(request.token);
    if (request.token.empty()) return Page<int>{{1, 2}, "empty"};
    if (request.token == "empty") return Page<int>{{}, "last"};
    return Page<int>{{3}, ""};
  };
  EXPECT_THAT(ReadAllPages<int>(read).value(), ElementsAre(1, 2, 3));
  EXPECT_THAT(tokens, ElementsAre("", "empty", "last"));
}

TEST(ListPage, AListThatRepeatsItselfEnds) {
  const auto read = [](const PageRequest&) -> absl::StatusOr<Page<int>> {
    return Page<int>{{1}, "same"};
  };
  EXPECT_THAT(ReadAllPages<int>(read).value(), ElementsAre(1, 1));
}

TEST(ListPage, HalfOfTheListIsAnError) {
  const auto read = [](const PageRequest& request) -> absl::StatusOr<Page<int>> {
    if (request.token.empty()) return Page<int>{{1}, "next"};
    return absl::DataLossError("damaged");
  };
  EXPECT_THAT(ReadAllPages<int>(read), HasStatus(absl::StatusCode::kDataLoss, "damaged"));
}

}  // namespace
}  // namespace pleat
