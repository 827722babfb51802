// The command line against a real server process over a socket.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include "e2e/pleat_program.h"
#include "e2e/report_checks.h"
#include "e2e/server_program.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

TEST(Server, TrainsToTheSameBytesAsLocalAndStreamsEditedFrames) {
  PleatProgram pleat;
  const std::string input = pleat.GeneratePerformer(40, 800);
  ServerProgram server(pleat.File("store"));
  const std::string address = server.WaitForAddress();
  ASSERT_NE(address, "") << server.log();

  const std::string remote = pleat.File("remote.pleat"), local = pleat.File("local.pleat");
  ProcessResult result = pleat.Run({"train", input, "--server", address, "-o", remote, "--learner",
                                    "gp", "--report", pleat.File("train.json")});
  ASSERT_EQ(result.exit_code, 0) << result.err << server.log();
  ExpectTrainReport(ParseJson(Bytes(pleat.File("train.json"))));
  result = pleat.Run({"train", input, "--local", "-o", local, "--learner", "gp"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_FALSE(Bytes(local).empty());
  EXPECT_TRUE(Bytes(local) == Bytes(remote));
  // The same once more through the store on this machine.
  result = pleat.Run({"train", input, "--local", "--data-dir", pleat.File("own"), "-o",
                      pleat.File("stored.pleat"), "--learner", "gp"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(Bytes(local) == Bytes(pleat.File("stored.pleat")));

  // Poses evaluated by the server arrive within half a step of the stream's grid.
  const std::string id = ParseJson(Bytes(pleat.File("train.json")))["model_id"];
  const std::string motion = pleat.File("motion.json");
  result = pleat.Run({"motion", local, input, "-o", motion, "--offset-rotation", "head=0,30,0"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  result = pleat.Run({"pose", local, "--motion", motion, "-o", pleat.File("exact.pseq")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  result = pleat.Run(
      {"pose", id, "--server", address, "--motion", motion, "-o", pleat.File("streamed")});
  ASSERT_EQ(result.exit_code, 0) << result.err << server.log();
  const nlohmann::json header = ParseJson(Bytes(pleat.File("streamed/stream.json")));
  result = pleat.Run({"compare", pleat.File("streamed"), pleat.File("exact.pseq"), "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const nlohmann::json compared = ParseJson(result.out);
  EXPECT_LE(
      compared["error"]["max_percent"].get<double>() / 100 * compared["diagonal_m"].get<double>(),
      0.5 * std::sqrt(3.0) * header["box"]["step_m"].get<double>() * 1.001);

  EXPECT_EQ(server.Stop().exit_code, 0) << server.log();
}

TEST(Server, SeveralClipsTrainOneCharacterHereAndThere) {
  PleatProgram pleat;
  const auto generate = [&](const std::string& folder, int frames, const std::string& seed_flag) {
    const ProcessResult result =
        pleat.Run({"generate", "performer", "-o", pleat.File(folder), "--frames",
                   std::to_string(frames), "--vertices", "800", seed_flag, "2", "--quiet"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return pleat.File(folder + "/performer.pc2");
  };
  const std::string first = pleat.GeneratePerformer(25, 800);
  const std::string second = generate("second", 20, "--seed");
  const std::string stranger = generate("stranger", 5, "--character-seed");
  ServerProgram server(pleat.File("store"));
  const std::string address = server.WaitForAddress();
  ASSERT_NE(address, "") << server.log();

  const std::string remote = pleat.File("remote.pleat"), local = pleat.File("local.pleat");
  ProcessResult result =
      pleat.Run({"train", first, second, "--server", address, "-o", remote, "--learner", "gp"});
  ASSERT_EQ(result.exit_code, 0) << result.err << server.log();
  result = pleat.Run({"train", first, second, "--local", "-o", local, "--learner", "gp", "--report",
                      pleat.File("train.json")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_FALSE(Bytes(local).empty());
  EXPECT_TRUE(Bytes(local) == Bytes(remote));
  EXPECT_EQ(ParseJson(Bytes(pleat.File("train.json")))["num_frames"], 45);

  // A clip of another mesh is named, on both sides.
  for (const std::vector<std::string>& where :
       {std::vector<std::string>{"--server", address}, std::vector<std::string>{"--local"}}) {
    std::vector<std::string> command = {"train", first, stranger, "-o", pleat.File("none.pleat")};
    command.insert(command.end(), where.begin(), where.end());
    result = pleat.Run(command);
    EXPECT_NE(result.exit_code, 0);
    EXPECT_THAT(result.err, HasSubstr("all clips of a character share one connectivity"));
  }
  EXPECT_EQ(server.Stop().exit_code, 0) << server.log();
}

TEST(Server, AnOwnRigWithALockedJointGivesTheSameBytesHereAndThere) {
  PleatProgram pleat;
  const std::string input = pleat.GeneratePerformer(20, 1000);
  const std::string rig = pleat.File("rig.json");
  ProcessResult result = pleat.Run({"rig", input, "--no-fit", "-o", rig});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  ServerProgram server(pleat.File("store"));
  const std::string address = server.WaitForAddress();
  ASSERT_NE(address, "") << server.log();
  const std::string remote = pleat.File("remote.pleat"), local = pleat.File("local.pleat");
  result = pleat.Run({"train", input, "--server", address, "-o", remote, "--learner", "gp", "--rig",
                      rig, "--lock", "leftLowerLeg,rightLowerLeg"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  result = pleat.Run({"train", input, "--local", "-o", local, "--learner", "gp", "--rig", rig,
                      "--lock", "leftLowerLeg,rightLowerLeg"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_FALSE(Bytes(local).empty());
  EXPECT_TRUE(Bytes(remote) == Bytes(local));
  result = pleat.Run(
      {"train", input, "--local", "-o", pleat.File("other.pleat"), "--rig", rig, "--lock", "tail"});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.err, HasSubstr("'tail'"));
  result =
      pleat.Run({"train", input, "--local", "-o", pleat.File("other.pleat"), "--lock", "head"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("--rig"));
}

TEST(Server, KeepsWhatItHasOverARestart) {
  PleatProgram pleat;
  const std::string input = pleat.GeneratePerformer(20, 800);
  std::string sequence_id;
  {
    ServerProgram server(pleat.File("store"));
    const std::string address = server.WaitForAddress();
    ASSERT_NE(address, "") << server.log();
    const ProcessResult result = pleat.Run({"upload", input, "--server", address});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    sequence_id = result.out.substr(0, 64);
    EXPECT_EQ(server.Stop().exit_code, 0) << server.log();
  }
  ServerProgram server(pleat.File("store"));
  const std::string address = server.WaitForAddress();
  ASSERT_NE(address, "") << server.log();
  ProcessResult result = pleat.Run({"sequences", "--server", address, "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(ParseJson(result.out)[0]["id"], sequence_id);
  result = pleat.Run({"sequences", "delete", sequence_id.substr(0, 8), "--server", address});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  result = pleat.Run({"sequences", "show", sequence_id, "--server", address});
  EXPECT_EQ(result.exit_code, 4);
}

TEST(Server, ControlCCancelsTheJob) {
  PleatProgram pleat;
  const std::string input = pleat.GeneratePerformer(60, 800);
  ServerProgram server(pleat.File("store"));
  const std::string address = server.WaitForAddress();
  ASSERT_NE(address, "") << server.log();
  const std::unique_ptr<Process> train =
      pleat.Start({"train", input, "--server", address, "-o", pleat.File("m.pleat"), "--learner",
                   "sgplvm", "--iterations", "10000"});
  ASSERT_TRUE(train->WaitForText("sgplvm: ", 60)) << train->err();
  train->Signal(SIGINT);
  EXPECT_EQ(train->Wait(5).exit_code, 7) << train->err();
  const ProcessResult jobs = pleat.Run({"jobs", "--server", address, "--json"});
  EXPECT_EQ(ParseJson(jobs.out)[0]["state"], "cancelled") << jobs.out;
}

TEST(Server, DetachedJobsCanBeWatchedAndTheirModelsDownloaded) {
  PleatProgram pleat;
  const std::string input = pleat.GeneratePerformer(30, 800);
  ServerProgram server(pleat.File("store"));
  const std::string address = server.WaitForAddress();
  ASSERT_NE(address, "") << server.log();
  ProcessResult result =
      pleat.Run({"train", input, "--server", address, "--learner", "gp", "--detach", "--quiet"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const std::string job = result.out.substr(0, result.out.find('\n'));
  result = pleat.Run({"jobs", "watch", job, "--server", address, "--quiet"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const std::string model = result.out.substr(0, result.out.find('\n'));
  result = pleat.Run({"models", "download", model, "--server", address, "-o", pleat.File("m")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_GT(Bytes(pleat.File("m")).size(), 1000u);
  EXPECT_EQ(pleat.Run({"models", "delete", model, "--server", address}).exit_code, 0);
  EXPECT_EQ(pleat.Run({"models", "show", model, "--server", address}).exit_code, 4);
}

}  // namespace
}  // namespace pleat
