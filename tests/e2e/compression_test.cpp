// Compression on a server, from the command line: the same bytes and frames as in this process.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include "e2e/pleat_program.h"
#include "e2e/report_checks.h"
#include "e2e/server_program.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

TEST(Compression, GivesTheSameBytesAndFramesHereAndThere) {
  PleatProgram pleat;
  const std::string input = pleat.GeneratePerformer(40, 800);
  ServerProgram server(pleat.File("store"));
  const std::string address = server.WaitForAddress();
  ASSERT_NE(address, "") << server.log();

  const std::string here = pleat.File("here.plt"), there = pleat.File("there.plt");
  ProcessResult result = pleat.Run({"compress", input, "-o", here, "--max-error-mm", "1"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  result = pleat.Run({"compress", input, "-o", there, "--max-error-mm", "1", "--server", address,
                      "--report", pleat.File("report.json")});
  ASSERT_EQ(result.exit_code, 0) << result.err << server.log();
  ASSERT_FALSE(Bytes(here).empty());
  EXPECT_TRUE(Bytes(here) == Bytes(there));
  const nlohmann::json report = ParseJson(Bytes(pleat.File("report.json")));
  EXPECT_EQ(report["schema"], "pleat.compress/1");
  EXPECT_EQ(report["bytes"], Bytes(here).size());
  EXPECT_LE(report["max_error_mm"].get<double>(), 1);
  EXPECT_GT(report["decode_seconds"].get<double>(), 0);
  // Once more through the store on this machine.
  const std::string stored = pleat.File("stored.plt");
  result = pleat.Run({"compress", input, "-o", stored, "--max-error-mm", "1", "--local",
                      "--data-dir", pleat.File("own")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(Bytes(here) == Bytes(stored));

  // Stored ones are decoded by id, files are uploaded first.
  result = pleat.Run({"compressed", "--server", address, "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const nlohmann::json listed = ParseJson(result.out);
  ASSERT_EQ(listed.size(), 1u);
  EXPECT_EQ(listed[0]["report"]["bytes"], Bytes(here).size());
  EXPECT_EQ(listed[0]["options"]["max_error_mm"], 1);
  const std::string id = listed[0]["id"];
  for (const std::vector<std::string>& range :
       {std::vector<std::string>{}, {"--frames", "7:21"}, {"--frames", "30:"}}) {
    std::string expected;
    for (const std::vector<std::string>& source : {std::vector<std::string>{here},
                                                   {here, "--server", address},
                                                   {id.substr(0, 10), "--server", address}}) {
      std::vector<std::string> command = {"decompress", "--force", "-o", pleat.File("out.pseq")};
      command.insert(command.end(), source.begin(), source.end());
      command.insert(command.end(), range.begin(), range.end());
      result = pleat.Run(command);
      ASSERT_EQ(result.exit_code, 0) << result.err << server.log();
      const std::string frames = Bytes(pleat.File("out.pseq"));
      ASSERT_FALSE(frames.empty());
      if (expected.empty()) expected = frames;
      EXPECT_TRUE(frames == expected);
    }
  }
  result = pleat.Run(
      {"decompress", id, "--server", address, "-o", pleat.File("x.pseq"), "--frames", "39:41"});
  EXPECT_EQ(result.exit_code, 3) << result.err;
  EXPECT_THAT(result.err, HasSubstr("which has 40"));

  result = pleat.Run({"jobs", "--server", address});
  EXPECT_THAT(result.out, HasSubstr("compression"));
  result =
      pleat.Run({"compressed", "download", id, "--server", address, "-o", pleat.File("again.plt")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(Bytes(pleat.File("again.plt")) == Bytes(here));
  EXPECT_EQ(pleat.Run({"compressed", "delete", id, "--server", address}).exit_code, 0);
  EXPECT_EQ(pleat.Run({"compressed", "show", id, "--server", address}).exit_code, 4);
  EXPECT_EQ(server.Stop().exit_code, 0) << server.log();
}

TEST(Compression, ControlCCancelsTheJobOnTheServer) {
  PleatProgram pleat;
  const std::string input = pleat.GeneratePerformer(250, 4000);
  ServerProgram server(pleat.File("store"));
  const std::string address = server.WaitForAddress();
  ASSERT_NE(address, "") << server.log();
  const std::unique_ptr<Process> compress = pleat.Start(
      {"compress", input, "--server", address, "-o", pleat.File("x.plt"), "--max-error-mm", ".05"});
  ASSERT_TRUE(compress->WaitForText("encode: ", 60)) << compress->err();
  compress->Signal(SIGINT);
  EXPECT_EQ(compress->Wait(5).exit_code, 7) << compress->err();
  const ProcessResult jobs = pleat.Run({"jobs", "--server", address, "--json"});
  EXPECT_EQ(ParseJson(jobs.out)[0]["state"], "cancelled") << jobs.out;
  EXPECT_EQ(ParseJson(jobs.out)[0]["kind"], "compression") << jobs.out;
}

}  // namespace
}  // namespace pleat
