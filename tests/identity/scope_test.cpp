#include "pleat/identity/scope.h"

#include <gtest/gtest.h>

#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

TEST(ScopeTest, EverySetIsWrittenAndReadBack) {
  for (unsigned bits = 1; bits < 16; ++bits) {
    ScopeSet scopes;
    for (const Scope scope : kScopes) {
      if (bits >> static_cast<unsigned>(scope) & 1) scopes.Add(scope);
    }
    PLEAT_ASSERT_OK_AND_ASSIGN(const ScopeSet read, ParseScopes(ScopesText(scopes)));
    EXPECT_EQ(read, scopes) << ScopesText(scopes);
  }
  EXPECT_EQ(ScopesText(ScopeSet::All()), "read,pose,train,admin");
}

TEST(ScopeTest, OrderDoesNotMatterAndUnknownNamesDo) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const ScopeSet scopes, ParseScopes("admin,read"));
  EXPECT_TRUE(scopes.Has(Scope::kAdmin));
  EXPECT_FALSE(scopes.Has(Scope::kPose));
  EXPECT_EQ(ScopesText(scopes), "read,admin");
  for (const char* text : {"", "read,", "write", "Read", "read pose", ","}) {
    EXPECT_THAT(ParseScopes(text),
                HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("read, pose, train")))
        << text;
  }
}

}  // namespace
}  // namespace pleat
