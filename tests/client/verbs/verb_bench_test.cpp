// Against a real server bench is tested in tests/e2e/bench_test.cpp; here what it refuses.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/tube_files.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

TEST(BenchVerbTest, MeasuresServersOnly) {
  const TubeFiles files;
  const Outcome outcome = files.RunInStore({"bench", "4f"});
  EXPECT_EQ(outcome.code, ExitCode::kUsage);
  EXPECT_THAT(outcome.err, HasSubstr("bench talks to a server: it has no --local"));
}

TEST(BenchVerbTest, AServerThatIsNotThereIsUnavailable) {
  const Outcome outcome = RunPleat({"bench", "4f", "--server", "127.0.0.1:1"});
  EXPECT_EQ(outcome.code, ExitCode::kUnavailable);
  EXPECT_THAT(outcome.err, HasSubstr("127.0.0.1:1"));
}

TEST(BenchVerbTest, LoadsOutOfRangeAndContradictionsAreUsageErrors) {
  for (const std::vector<std::string>& flags :
       std::vector<std::vector<std::string>>{{"--clients", "0"},
                                             {"--clients", "1001"},
                                             {"--rate", "0"},
                                             {"--seconds", "-1"},
                                             {"--max-in-flight", "65"},
                                             {"--bits", "7"},
                                             {"--encoding", "zip"},
                                             {"--arrivals", "bursts"},
                                             {"--arrivals", "fixed", "--closed-loop"},
                                             {"--content", "skeleton"}}) {
    std::vector<std::string> arguments = {"bench", "4f", "--server", "127.0.0.1:1"};
    arguments.insert(arguments.end(), flags.begin(), flags.end());
    const Outcome outcome = RunPleat(arguments);
    EXPECT_EQ(outcome.code, ExitCode::kUsage) << testing::PrintToString(flags);
    EXPECT_THAT(outcome.err, HasSubstr("Try 'pleat bench --help'."));
  }
}

}  // namespace
}  // namespace pleat
