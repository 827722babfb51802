#include "cli/show/manual.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "absl/strings/str_split.h"
#include "client/run_pleat.h"

namespace pleat {
namespace {

using testing::HasSubstr;

TEST(ManualTest, NoTextIsTakenForARequest) {
  const Command program{
      .path = {},
      .description = ".one\n'two\n\\three-four",
      .flags = {},
      .verbs = {{.path = {"train"},
                 .description = "makes",
                 .flags = {{.names = {}, .positional = "INPUT", .value = "TEXT", .required = true},
                           {.names = {"-o", "--output"}, .value = "TEXT", .description = ".pleat"}},
                 .verbs = {}}}};
  const std::string page = ManualPage(program, "1.2");
  EXPECT_THAT(page, HasSubstr("\\&.one\n\\&'two\n\\ethree\\-four\n"));
  EXPECT_THAT(page, HasSubstr(".SS train INPUT\n"));
  EXPECT_THAT(page, HasSubstr("\\fB\\-o\\fR, \\fB\\-\\-output\\fR \\fITEXT\\fR\n\\&.pleat\n"));
}

TEST(ManualTest, ThePageOfTheProgramHasEveryVerb) {
  const Outcome outcome = RunPleat({"manual"});
  ASSERT_EQ(outcome.code, ExitCode::kOk);
  for (const char* verb :
       {"train", "motion edit", "batch LIST", "studio [INPUT]", "store ACTION"}) {
    EXPECT_THAT(outcome.out, HasSubstr(std::string(".SS ") + verb)) << verb;
  }
  // Requests alone begin with a dot.
  const std::vector<std::string> lines = absl::StrSplit(outcome.out, '\n');
  for (const std::string& line : lines) {
    if (!line.starts_with(".")) continue;
    EXPECT_TRUE(line.starts_with(".TH ") || line.starts_with(".SH ") || line.starts_with(".SS ") ||
                line.starts_with(".B ") || line.starts_with(".I ") || line == ".TP" ||
                line == ".nf" || line == ".fi")
        << line;
  }
}

}  // namespace
}  // namespace pleat
