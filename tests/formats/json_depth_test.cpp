#include "json_depth.h"

#include <gtest/gtest.h>

#include <string>

namespace pleat {
namespace {

TEST(NestsTooDeep, CountsOpenBracketsOutsideStrings) {
  EXPECT_FALSE(NestsTooDeep("", 1));
  EXPECT_FALSE(NestsTooDeep("[{}]", 2));
  EXPECT_TRUE(NestsTooDeep("[{}]", 1));
  EXPECT_FALSE(NestsTooDeep("[[], [], []]", 2));
  EXPECT_FALSE(NestsTooDeep(R"(["[[[", "\"[[[", "\\"])", 1));
  EXPECT_TRUE(NestsTooDeep(R"(["\\", [[]]])", 2));
  EXPECT_TRUE(NestsTooDeep(std::string(1000, '['), 64));
}

}  // namespace
}  // namespace pleat
