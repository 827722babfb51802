#include "cli/verbs/content_flag.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>

namespace pleat {
namespace {

StreamContent Parse(std::vector<std::string> arguments, StreamContent content) {
  CLI::App app;
  AddContentFlag(&app, &content);
  std::reverse(arguments.begin(), arguments.end());
  app.parse(arguments);
  return content;
}

TEST(ContentFlagTest, EveryNameSetsItsContent) {
  for (const StreamContent content :
       {StreamContent::kMesh, StreamContent::kControlMesh, StreamContent::kParameters}) {
    for (const StreamContent before : {StreamContent::kMesh, StreamContent::kParameters}) {
      EXPECT_EQ(Parse({"--content", StreamContentName(content)}, before), content);
    }
  }
}

TEST(ContentFlagTest, NamesAreThoseOfTheDocumentation) {
  EXPECT_STREQ(StreamContentName(StreamContent::kMesh), "mesh");
  EXPECT_STREQ(StreamContentName(StreamContent::kControlMesh), "control");
  EXPECT_STREQ(StreamContentName(StreamContent::kParameters), "parameters");
}

TEST(ContentFlagTest, WithoutTheFlagNothingChanges) {
  EXPECT_EQ(Parse({}, StreamContent::kControlMesh), StreamContent::kControlMesh);
}

TEST(ContentFlagTest, OtherNamesAreRefusedWithTheKnownOnes) {
  try {
    Parse({"--content", "skeleton"}, StreamContent::kMesh);
    FAIL() << "accepted";
  } catch (const CLI::ParseError& error) {
    EXPECT_THAT(error.what(),
                testing::AllOf(testing::HasSubstr("mesh"), testing::HasSubstr("control"),
                               testing::HasSubstr("parameters")));
  }
}

TEST(ContentFlagTest, HelpNamesTheDefault) {
  CLI::App app;
  StreamContent content = StreamContent::kControlMesh;
  AddContentFlag(&app, &content);
  EXPECT_EQ(app.get_option("--content")->get_default_str(), "control");
}

}  // namespace
}  // namespace pleat
