#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/run_pleat.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

TEST(StatusVerbTest, AServerThatDoesNotAnswerHasItsExitCode) {
  const Outcome outcome = RunPleat({"status", "--server", "127.0.0.1:1"});
  EXPECT_EQ(outcome.code, ExitCode::kUnavailable);
  EXPECT_THAT(outcome.err, HasSubstr("127.0.0.1:1"));
}

TEST(StatusVerbTest, AsksAServerAlone) {
  EXPECT_EQ(RunPleat({"status", "--local"}).code, ExitCode::kUsage);
}

}  // namespace
}  // namespace pleat
