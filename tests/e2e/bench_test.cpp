// `pleat bench` against a real server process.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <map>
#include <thread>

#include "e2e/pleat_program.h"
#include "e2e/report_checks.h"
#include "e2e/server_program.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

class Bench : public testing::Test {
 protected:
  void SetUp() override {
    address_ = server_.WaitForAddress();
    ASSERT_NE(address_, "") << server_.log();
    const std::string input = pleat_.GeneratePerformer(25, 800);
    const ProcessResult result =
        pleat_.Run({"train", input, "--server", address_, "-o", pleat_.File("m.pleat"), "--learner",
                    "gp", "--refine", "none", "--report", pleat_.File("train.json")});
    ASSERT_EQ(result.exit_code, 0) << result.err << server_.log();
    id_ = ParseJson(Bytes(pleat_.File("train.json")))["model_id"];
  }

  std::vector<std::string> Command(const std::vector<std::string>& more) {
    std::vector<std::string> command = {"bench",        id_,      "--server", address_, "--report",
                                        File("b.json"), "--force"};
    command.insert(command.end(), more.begin(), more.end());
    return command;
  }
  std::string File(const std::string& name) { return pleat_.File(name); }
  nlohmann::json Report() { return ParseJson(Bytes(File("b.json"))); }

  PleatProgram pleat_;
  ServerProgram server_{pleat_.File("store")};
  std::string address_, id_;
};

TEST_F(Bench, ReportsLatenciesServerTimesAndThroughput) {
  for (const std::string arrivals : {"fixed", "poisson"}) {
    const ProcessResult result =
        pleat_.Run(Command({"--clients", "3", "--rate", "40", "--seconds", "1", "--arrivals",
                            arrivals, "--encoding", "points", "--plot", File("b.png")}));
    ASSERT_EQ(result.exit_code, 0) << result.err << server_.log();
    EXPECT_THAT(result.out, HasSubstr("p99.9"));
    const nlohmann::json report = Report();
    EXPECT_EQ(report["schema"], "pleat.bench/1");
    EXPECT_EQ(report["arrivals"], arrivals);
    EXPECT_EQ(report["num_clients"], 3);
    EXPECT_NEAR(report["num_poses"], 120, arrivals == "fixed" ? 0 : 60);
    EXPECT_EQ(report["num_frames"], report["num_poses"]);
    EXPECT_EQ(report["num_rejected"], 0);
    EXPECT_NEAR(report["num_vertices"], 800, 80);
    for (const nlohmann::json& times :
         {report["latency_ms"], report["server_ms"]["evaluate"], report["server_ms"]["encode"]}) {
      ExpectNumbers(times, {"mean", "p50", "p90", "p99", "p99_9", "max"});
      EXPECT_GT(times["p50"], 0);
      EXPECT_LE(times["p50"], times["p90"]);
      EXPECT_LE(times["p90"], times["p99"]);
      EXPECT_LE(times["p99_9"], times["max"]);
    }
    EXPECT_GE(report["latency_ms"]["p50"], report["server_ms"]["evaluate"]["p50"]);
    ExpectNumbers(report, {"bytes_per_frame", "server_cpu_seconds", "frames_per_cpu_second",
                           "share_of_draco", "num_superseded", "num_resumed"});
    EXPECT_GT(report["server_cpu_seconds"], 0);
    EXPECT_GT(report["draco"]["frames_per_cpu_second"], 100);
    EXPECT_LE(report["achieved_fps"]["lowest"], report["achieved_fps"]["highest"]);
    EXPECT_EQ(Bytes(File("b.png")).substr(1, 3), "PNG");
  }
}

TEST_F(Bench, FramesOfParametersAndControlMeshesAreSmall) {
  std::map<std::string, double> num_bytes;
  for (const std::string content : {"mesh", "control", "parameters"}) {
    const ProcessResult result = pleat_.Run(
        Command({"--rate", "60", "--seconds", ".3", "--encoding", "points", "--content", content}));
    ASSERT_EQ(result.exit_code, 0) << result.err << server_.log();
    EXPECT_EQ(Report()["content"], content);
    num_bytes[content] = Report()["bytes_per_frame"];
  }
  EXPECT_LT(num_bytes["control"], .3 * num_bytes["mesh"]);
  EXPECT_GT(num_bytes["parameters"], 18 * 4 * 4);  // at least the rotations
  EXPECT_LT(num_bytes["parameters"], 1000);
}

// Of 1.5 s the server stands still for half a second: a third of the poses should have been sent
// meanwhile. A tool that waited for the server would show one slow frame.
TEST_F(Bench, AStandstillOfTheServerShowsInThePercentiles) {
  const auto run = pleat_.Start(
      Command({"--rate", "60", "--seconds", "1.5", "--max-in-flight", "2", "--encoding", "delta"}));
  ASSERT_TRUE(run->WaitForText("sending poses")) << run->err();
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  server_.Signal(SIGSTOP);
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  server_.Signal(SIGCONT);
  const ProcessResult result = run->Wait(60);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const nlohmann::json report = Report();
  EXPECT_EQ(report["num_frames"], 90);
  EXPECT_GE(report["latency_ms"]["max"], 300);
  EXPECT_GE(report["latency_ms"]["p90"], 100);
}

TEST_F(Bench, ClosedLoopLatestPoseAndAMotionFromAFile) {
  ProcessResult result = pleat_.Run({"motion", File("m.pleat"), File("made/performer.pc2"), "-o",
                                     File("motion.json"), "--quiet"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  result = pleat_.Run(Command({"--closed-loop", "--seconds", ".5", "--clients", "2", "--motion",
                               File("motion.json"), "--json"}));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(ParseJson(result.out)["arrivals"], "closed");
  EXPECT_GT(ParseJson(result.out)["num_frames"], 10);
  // More than any server can do: what is not shown has been superseded.
  result = pleat_.Run(Command({"--latest-wins", "--rate", "8000", "--seconds", ".5"}));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const nlohmann::json report = Report();
  EXPECT_GT(report["num_superseded"], 0);
  EXPECT_EQ(report["num_frames"].get<int>() + report["num_superseded"].get<int>(),
            report["num_sent"].get<int>());
}

TEST_F(Bench, SaysWhatIsWrong) {
  ProcessResult result = pleat_.Run({"bench", "ffff", "--server", address_});
  EXPECT_EQ(result.exit_code, 4) << result.err;
  result = pleat_.Run({"bench", id_, "--local"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("no --local"));
  result = pleat_.Run(Command({"--motion", File("none.json")}));
  EXPECT_EQ(result.exit_code, 4) << result.err;
}

}  // namespace
}  // namespace pleat
