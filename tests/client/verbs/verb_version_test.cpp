#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "client/run_pleat.h"

namespace pleat {
namespace {

using ::testing::MatchesRegex;

TEST(VersionVerbTest, TextAndJsonSayTheSameVersion) {
  const Outcome text = RunPleat({"version"});
  EXPECT_EQ(text.code, ExitCode::kOk);
  EXPECT_THAT(text.out, MatchesRegex("pleat [0-9]+\\.[0-9]+\\.[0-9]+\n"));
  const auto json = nlohmann::json::parse(RunPleat({"version", "--json"}).out);
  EXPECT_EQ("pleat " + json["version"].get<std::string>() + "\n", text.out);
}

TEST(VersionVerbTest, TakesNoArguments) {
  EXPECT_EQ(RunPleat({"version", "now"}).code, ExitCode::kUsage);
  EXPECT_EQ(RunPleat({"version", "--local"}).code, ExitCode::kUsage);
}

}  // namespace
}  // namespace pleat
