#include "pleat/base/project.h"

#include <gtest/gtest.h>

#include <string>

#include "support/status_matchers.h"

namespace pleat {
namespace {

TEST(ProjectTest, ANameIsSafeInPathsAndLogs) {
  for (const char* name : {kDefaultProject, "robots", "film-2", "0_1", "a"}) {
    EXPECT_THAT(CheckProjectName(name), IsOk()) << name;
  }
  EXPECT_THAT(CheckProjectName(std::string(48, 'a')), IsOk());
  for (const std::string& name :
       {std::string(), std::string(49, 'a'), std::string(".."), std::string("a/b"),
        std::string("Robots"), std::string("-x"), std::string("a b"), std::string("a\n"),
        std::string("\0", 1), std::string("r\xc3\xb6")}) {
    EXPECT_THAT(CheckProjectName(name), HasStatus(kInvalid, testing::HasSubstr("project")));
  }
}

}  // namespace
}  // namespace pleat
