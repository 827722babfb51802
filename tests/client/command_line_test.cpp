#include "cli/command_line.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <new>
#include <stdexcept>

#include "client/run_pleat.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;

TEST(CommandLine, NothingAndNonsenseAreUsageErrors) {
  EXPECT_EQ(RunPleat({}).code, ExitCode::kUsage);
  EXPECT_EQ(RunPleat({"dance"}).code, ExitCode::kUsage);
  const Outcome flag = RunPleat({"inspect", "x", "--wrong"});
  EXPECT_EQ(flag.code, ExitCode::kUsage);
  EXPECT_THAT(flag.err, StartsWith("pleat inspect: "));
  EXPECT_THAT(flag.err, HasSubstr("Try 'pleat inspect --help'."));
  EXPECT_EQ(RunPleat({"inspect"}).code, ExitCode::kUsage);
  EXPECT_THAT(flag.out, IsEmpty());
}

TEST(CommandLine, HelpGoesToTheOutputAndListsExitCodes) {
  const Outcome help = RunPleat({"--help"});
  EXPECT_EQ(help.code, ExitCode::kOk);
  EXPECT_THAT(help.out, HasSubstr("Exit codes:"));
  EXPECT_THAT(help.out, HasSubstr("inspect"));
  const Outcome verb = RunPleat({"inspect", "--help"});
  EXPECT_EQ(verb.code, ExitCode::kOk);
  EXPECT_THAT(verb.out, HasSubstr("--json"));
}

TEST(CommandLine, VersionInBothForms) {
  EXPECT_THAT(RunPleat({"version"}).out, StartsWith("pleat "));
  EXPECT_THAT(RunPleat({"version", "--json"}).out, StartsWith("{\"version\":\""));
}

TEST(CommandLine, MissingInputIsNotFoundAndNamed) {
  const Outcome outcome = RunPleat({"inspect", "/nowhere/at/all.obj"});
  EXPECT_EQ(outcome.code, ExitCode::kNotFound);
  EXPECT_THAT(outcome.err, StartsWith("pleat inspect: "));
  EXPECT_THAT(outcome.err, HasSubstr("/nowhere/at/all.obj"));
}

// What a verb throws, the user sees as a sentence and an exit code.
TEST(CommandLine, TheTextOfAnExceptionReachesNobody) {
  const auto run_throwing = [](const auto& exception) {
    std::ostringstream out, err;
    Session session;
    session.out = &out;
    session.err = &err;
    session.verb = "inspect";
    session.run = [&]() -> absl::Status { throw exception; };
    const ExitCode code = RunChosenVerb(session);
    EXPECT_THAT(err.str(), StartsWith("pleat inspect: "));
    EXPECT_THAT(err.str(), Not(HasSubstr("secret")));
    EXPECT_THAT(err.str(), Not(HasSubstr("std::")));
    return code;
  };
  EXPECT_EQ(run_throwing(std::bad_alloc()), ExitCode::kLimit);
  EXPECT_EQ(run_throwing(std::length_error("secret")), ExitCode::kLimit);
  EXPECT_EQ(run_throwing(std::out_of_range("secret")), ExitCode::kInternal);
  EXPECT_EQ(run_throwing(std::filesystem::filesystem_error(
                "secret", "a.obj", std::make_error_code(std::errc::no_such_file_or_directory))),
            ExitCode::kNotFound);
}

}  // namespace
}  // namespace pleat
