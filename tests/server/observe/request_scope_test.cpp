#include "pleat/observe/request_scope.h"

#include <gtest/gtest.h>

#include <string>
#include <thread>

namespace pleat {
namespace {

TEST(RequestScopeTest, ScopesNestAndBelongToTheirThread) {
  EXPECT_EQ(CurrentRequestId(), "");
  {
    const RequestTag a{.id = "a"}, b{.id = "b", .project = "robots"};
    const RequestScope outer(a);
    {
      const RequestScope inner(b);
      EXPECT_EQ(CurrentRequestId(), "b");
      EXPECT_EQ(CurrentRequest().project, "robots");
    }
    EXPECT_EQ(CurrentRequestId(), "a");
    std::thread([] { EXPECT_EQ(CurrentRequestId(), ""); }).join();
  }
  EXPECT_EQ(CurrentRequestId(), "");
}

TEST(RequestScopeTest, OnlyIdsThatCanStandInALogAreTaken) {
  EXPECT_EQ(RequestIdOr("shot-12_b.7"), "shot-12_b.7");
  for (const std::string& bad :
       {std::string(), std::string(65, 'a'), std::string("a b"), std::string("a\"b"),
        std::string("a\n2026 forged"), std::string("\xc3\xa9")}) {
    const std::string made = RequestIdOr(bad);
    EXPECT_EQ(made.size(), 16u);
    EXPECT_NE(made, RequestIdOr(bad));
  }
}

}  // namespace
}  // namespace pleat
