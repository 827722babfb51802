#include "cli/batch/batch_list.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/status_matchers.h"

namespace pleat {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr absl::StatusCode kWrongList = absl::StatusCode::kInvalidArgument;

TEST(BatchListTest, LinesArePathsOrObjects) {
  const auto takes = ParseBatchList(
                         "# a day of takes\n"
                         "walk.pc2\r\n"
                         "\n"
                         "  /data/run.abc  \n"
                         R"({"input": ["a.obj", "b.obj"], "name": "dress"})"
                         "\n"
                         R"({"input": "jump.glb"})",
                         "/takes")
                         .value();
  ASSERT_EQ(takes.size(), 4u);
  EXPECT_EQ(takes[0].name, "walk");
  EXPECT_THAT(takes[0].inputs, ElementsAre("/takes/walk.pc2"));
  EXPECT_EQ(takes[0].line, 2);
  EXPECT_THAT(takes[1].inputs, ElementsAre("/data/run.abc"));
  EXPECT_EQ(takes[2].name, "dress");
  EXPECT_THAT(takes[2].inputs, ElementsAre("/takes/a.obj", "/takes/b.obj"));
  EXPECT_EQ(takes[3].name, "jump");
  EXPECT_EQ(takes[3].line, 6);
}

TEST(BatchListTest, TakesOfTheSameFileNameAreToldApartByTheirFolders) {
  const auto takes =
      ParseBatchList("s1/a/body.abc\ns1/b/body.abc\ns2/a/body.abc\ncape.abc\nwalk/\n", ".").value();
  std::vector<std::string> names;
  for (const BatchTake& take : takes) names.push_back(take.name);
  EXPECT_THAT(names, ElementsAre("s1_a_body", "b_body", "s2_a_body", "cape", "walk"));
}

TEST(BatchListTest, WhatIsWrongIsSaidWithItsLine) {
  const std::pair<const char*, const char*> lists[] = {
      {"", "names no takes"},
      {"# nothing\n", "names no takes"},
      {"a.pc2\n{\"input\": 5}", "line 2"},
      {"{", "line 1"},
      {"{\"name\": \"x\"}", "no \"input\""},
      {"{\"input\": [1]}", "lists something else"},
      {"{\"input\": \"a\", \"color\": 1}", "'color'"},
      {"{\"input\": \"a\", \"name\": \"x/y\"}", "without slashes"},
      {"{\"input\": \"a\", \"name\": \"..\"}", "cannot be the name"},
      {"a.pc2\n{\"input\": \"b\", \"name\": \"a\"}\n{\"input\": \"c\", \"name\": \"a\"}", "line 2"},
      {"a.pc2\na.pc2", "line 2"}};
  for (const auto& [text, reason] : lists) {
    EXPECT_THAT(ParseBatchList(text, "."), HasStatus(kWrongList, HasSubstr(reason))) << text;
  }
}

}  // namespace
}  // namespace pleat
