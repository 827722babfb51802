#include "cli/verbs/train_flags.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "absl/strings/str_replace.h"
#include "cli/exit_code.h"
#include "support/option_choices.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

absl::StatusOr<TrainOptions> Parse(std::vector<std::string> arguments) {
  CLI::App app;
  TrainFlags flags;
  AddTrainFlags(&app, &flags);
  std::reverse(arguments.begin(), arguments.end());
  app.parse(arguments);
  return ResolveTrainFlags(flags);
}

TEST(TrainFlags, DefaultsAreTheLibrarys) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const TrainOptions options, Parse({}));
  EXPECT_EQ(options, TrainOptions());
}

TEST(TrainFlags, FlagsWinOverThePresetWhereverTheyStand) {
  TrainOptions expected = TrainOptions::Paper();
  expected.resolution_percent = 100;
  expected.seed = 7;
  PLEAT_ASSERT_OK_AND_ASSIGN(const TrainOptions options,
                             Parse({"--resolution", "100", "--preset", "paper", "--seed", "7"}));
  EXPECT_EQ(options, expected);
}

TEST(TrainFlags, EveryOptionHasAFlagWithHelp) {
  CLI::App app;
  TrainFlags flags;
  AddTrainFlags(&app, &flags);
  const TrainOptions defaults;
  VisitTrainOptions(defaults, [&app](const char* name, const auto&) {
    const std::string flag = "--" + absl::StrReplaceAll(name, {{"_", "-"}});
    const CLI::Option* option = app.get_option_no_throw(flag);
    ASSERT_NE(option, nullptr) << flag;
    EXPECT_GT(option->get_description().size(), 20u) << flag;
  });
}

TEST(TrainFlags, AliasesOfTheShortNames) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const TrainOptions options,
                             Parse({"--axes", "world", "--yaw", "90", "--resolution", "5"}));
  EXPECT_EQ(options.detail_axes, DetailAxes::kWorld);
  EXPECT_EQ(options.yaw_degrees, 90);
  EXPECT_EQ(options.resolution_percent, 5);
}

TEST(TrainFlags, EveryChoiceIsAFlagValueAndInTheHelp) {
  CLI::App app;
  TrainFlags flags;
  AddTrainFlags(&app, &flags);
  ForEachChoice(
      [&app](const std::string& option, const std::string& name, const TrainOptions& expected) {
        const std::string flag = "--" + absl::StrReplaceAll(option, {{"_", "-"}});
        PLEAT_ASSERT_OK_AND_ASSIGN(const TrainOptions options, Parse({flag, name}));
        EXPECT_EQ(options, expected) << flag << " " << name;
        EXPECT_THAT(app.get_option(flag)->get_description(), HasSubstr(name + " ("));
        const absl::Status unknown = Parse({flag, "magic"}).status();
        EXPECT_TRUE(IsUsageError(unknown)) << flag;
        EXPECT_THAT(std::string(unknown.message()), HasSubstr(name));
      });
}

TEST(TrainFlags, WrongValuesAreUsageErrorsThatNameOptionAndRange) {
  const absl::Status learner = Parse({"--learner", "magic"}).status();
  EXPECT_TRUE(IsUsageError(learner));
  EXPECT_THAT(std::string(learner.message()), HasSubstr("sgplvm"));
  EXPECT_TRUE(IsUsageError(Parse({"--history", "0"}).status()));
  EXPECT_TRUE(IsUsageError(Parse({"--iterations", "ten"}).status()));
  EXPECT_TRUE(IsUsageError(Parse({"--learner", "gp\nseed=2"}).status()));
  EXPECT_THROW(Parse({"--preset", "best"}), CLI::ParseError);
}

}  // namespace
}  // namespace pleat
