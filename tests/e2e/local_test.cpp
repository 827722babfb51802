// The command line alone: from a made-up performer to edited frames, without a server.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include "e2e/pleat_program.h"
#include "e2e/report_checks.h"
#include "e2e/sequence_difference.h"
#include "pleat/formats/sequence_reader.h"
#include "pleat/stream/frame_decoder.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST(Local, TrainsPosesAndMeasures) {
  PleatProgram pleat;
  const std::string input = pleat.GeneratePerformer(60, 1200);
  const std::string model = pleat.File("m.pleat");
  ProcessResult result = pleat.Run({"train", input, "--local", "-o", model, "--learner", "gp",
                                    "--report", pleat.File("train.json")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const nlohmann::json report = ParseJson(Bytes(pleat.File("train.json")));
  ExpectTrainReport(report);
  EXPECT_EQ(report["model_bytes"], Bytes(model).size());
  EXPECT_LT(report["reconstruction"]["mean_percent"], report["fit"]["mean_percent"]);

  // The motion of the input, played back, is the input again but for what the model leaves out.
  const std::string motion = pleat.File("motion.json"), copy = pleat.File("copy.pc2");
  result = pleat.Run({"motion", model, input, "-o", motion});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  result = pleat.Run({"pose", model, "--motion", motion, "-o", copy, "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_GT(ParseJson(result.out)["confidence"]["mean"], 0.95) << result.out;
  result = pleat.Run({"compare", copy, input, "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_LT(ParseJson(result.out)["error"]["mean_percent"], report["fit"]["mean_percent"]);

  result = pleat.Run({"render", input, copy, "--model", model, "-o", pleat.File("sheet.png"),
                      "--count", "3", "--tile-width", "64", "--tile-height", "96"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(Bytes(pleat.File("sheet.png")), StartsWith("\x89PNG"));
}

TEST(Local, EditedFramesDecodeToTheEvaluatorsPositions) {
  PleatProgram pleat;
  const std::string input = pleat.GeneratePerformer(30, 800);
  const std::string model = pleat.File("m.pleat"), motion = pleat.File("edited.json");
  ASSERT_EQ(pleat.Run({"train", input, "--local", "-o", model, "--learner", "gp"}).exit_code, 0);
  ProcessResult result = pleat.Run({"motion", model, input, "-o", motion, "--scale-rotation",
                                    "leftLowerArm=1.3", "--offset-rotation", "head=0,30,0",
                                    "--bone-scale", "leftLowerArm=1.2", "--time-scale", "1.5"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  for (const char* out : {"exact.pseq", "clouds", "meshes", "objs"}) {
    std::vector<std::string> command = {"pose", model, "--motion", motion, "-o", pleat.File(out)};
    if (out == std::string("clouds")) command.insert(command.end(), {"--encoding", "points"});
    if (out == std::string("objs")) command.insert(command.end(), {"--format", "obj"});
    result = pleat.Run(command);
    ASSERT_EQ(result.exit_code, 0) << out << result.err;
  }
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence exact, ReadSequence(pleat.File("exact.pseq")));
  EXPECT_EQ(exact.num_frames(), 45);  // round(29 * 1.5) + 1
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence objs, ReadSequence(pleat.File("objs")));
  EXPECT_EQ(LargestDifference(exact, objs), 0);
  for (const char* folder : {"clouds", "meshes"}) {
    const nlohmann::json header = ParseJson(Bytes(pleat.File(folder) + "/stream.json"));
    EXPECT_EQ(header["num_frames"], 45);
    result = pleat.Run({"compare", pleat.File(folder), pleat.File("exact.pseq"), "--json"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const nlohmann::json compared = ParseJson(result.out);
    const double largest_m =
        compared["error"]["max_percent"].get<double>() / 100 * compared["diagonal_m"].get<double>();
    EXPECT_GT(largest_m, 0);
    // Half a step along each of three axes.
    EXPECT_LE(largest_m, 0.5 * std::sqrt(3.0) * header["box"]["step_m"].get<double>() * 1.001);
  }
}

TEST(Local, EvaluatesHeldOutFrames) {
  PleatProgram pleat;
  const std::string input = pleat.GeneratePerformer(60, 800);
  const ProcessResult result =
      pleat.Run({"evaluate", input, "--protocol", "every5th", "--learner", "gp", "--iterations",
                 "10", "--report", pleat.File("r.json")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  ExpectEvaluateReport(ParseJson(Bytes(pleat.File("r.json"))), "every5th");
  EXPECT_THAT(result.out, HasSubstr("baseline nearest"));
}

TEST(Local, SameBytesTwiceAndForAnyNumberOfThreads) {
  PleatProgram pleat;
  const std::string input = pleat.GeneratePerformer(30, 800);
  const std::string one = pleat.File("one.pleat"), two = pleat.File("two.pleat");
  for (const auto& [path, threads] : {std::pair(one, "1"), std::pair(two, "3")}) {
    const ProcessResult result = pleat.Run({"train", input, "--local", "-o", path, "--threads",
                                            threads, "--preset", "paper", "--iterations", "5"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
  }
  EXPECT_FALSE(Bytes(one).empty());
  EXPECT_TRUE(Bytes(one) == Bytes(two));
}

TEST(Local, ControlCStopsTrainingWithinASecond) {
  PleatProgram pleat;
  const std::string input = pleat.GeneratePerformer(60, 800);
  const std::unique_ptr<Process> train =
      pleat.Start({"train", input, "--local", "-o", pleat.File("m.pleat"), "--learner", "sgplvm",
                   "--iterations", "10000"});
  ASSERT_TRUE(train->WaitForText("sgplvm: ", 60)) << train->err();
  train->Signal(SIGINT);
  const ProcessResult result = train->Wait(5);
  EXPECT_EQ(result.exit_code, 7) << result.err;
  EXPECT_THAT(result.err, HasSubstr("pleat train: "));
  EXPECT_EQ(Bytes(pleat.File("m.pleat")), "");
}

TEST(Local, FailuresHaveTheirOwnExitCodesAndNameTheReason) {
  PleatProgram pleat;
  EXPECT_EQ(pleat.Run({"train", pleat.File("no.pc2"), "--local", "-o", "x"}).exit_code, 4);
  EXPECT_EQ(pleat.Run({"train", "x.pc2", "--local"}).exit_code, 2);
  EXPECT_EQ(pleat.Run({"pose", pleat.File("no.pleat"), "--motion", "m", "-o", "x"}).exit_code, 4);
  EXPECT_EQ(pleat.Run({"jobs", "--server", "127.0.0.1:1"}).exit_code, 6);
  ASSERT_THAT(WriteFile(pleat.File("bad.obj"), "v 0 0 nan\n"), IsOk());
  EXPECT_EQ(pleat.Run({"inspect", pleat.File("bad.obj")}).exit_code, 3);
  ASSERT_THAT(WriteFile(pleat.File("bad.pleat"), "not a model"), IsOk());
  const ProcessResult bad =
      pleat.Run({"pose", pleat.File("bad.pleat"), "--motion", "m", "-o", "x"});
  EXPECT_EQ(bad.exit_code, 3);
  EXPECT_THAT(bad.err, StartsWith("pleat pose: "));
}

TEST(Local, RefusesWhatIsNotHumanLike) {
  PleatProgram pleat;
  // A closed box: eight vertices, six quads.
  const std::string box =
      "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n"
      "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 3 4 8 7\nf 2 3 7 6\nf 4 1 5 8\n";
  for (int t = 0; t < 6; ++t) {
    ASSERT_THAT(WriteFile(pleat.File("box/frame" + std::to_string(t) + ".obj"), box), IsOk());
  }
  const ProcessResult result = pleat.Run(
      {"train", pleat.File("box"), "--local", "-o", pleat.File("m.pleat"), "--rest-frame", "0"});
  EXPECT_EQ(result.exit_code, 5) << result.err;
}

TEST(Local, CompressesWithAPromiseAndDecodesRanges) {
  PleatProgram pleat;
  const std::string input = pleat.GeneratePerformer(40, 800);
  const std::string file = pleat.File("x.plt"), copy = pleat.File("copy.pc2");
  ProcessResult result = pleat.Run(
      {"compress", input, "-o", file, "--max-error-mm", "1", "--report", pleat.File("r.json")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const nlohmann::json report = ParseJson(Bytes(pleat.File("r.json")));
  EXPECT_EQ(report["schema"], "pleat.compress/1");
  EXPECT_EQ(report["bytes"], Bytes(file).size());
  EXPECT_LE(report["max_error_mm"], 1);
  EXPECT_GT(report["encode_seconds"], 0);
  EXPECT_GT(report["decode_seconds"], 0);

  ASSERT_EQ(pleat.Run({"decompress", file, "-o", copy}).exit_code, 0);
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence truth, ReadSequence(input));
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence decoded, ReadSequence(copy));
  EXPECT_LE(LargestDifference(truth, decoded), 1e-3);
  EXPECT_TRUE(decoded.topology() == truth.topology());
  EXPECT_NEAR(report["bpvf"], 8.0 * Bytes(file).size() / (40.0 * truth.num_vertices()), 1e-9);

  result = pleat.Run({"decompress", file, "-o", pleat.File("few.pseq"), "--frames", "17:20"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence few, ReadSequence(pleat.File("few.pseq")));
  ASSERT_EQ(few.num_frames(), 3);
  EXPECT_EQ(few.frame(0), decoded.frame(17));

  EXPECT_EQ(pleat.Run({"compress", input, "--force", "-o", file}).exit_code, 2);
  EXPECT_EQ(pleat.Run({"decompress", file, "--force", "-o", copy, "--frames", "3"}).exit_code, 2);
  EXPECT_EQ(pleat.Run({"decompress", file, "--force", "-o", copy, "--frames", "3:99"}).exit_code,
            3);
  EXPECT_EQ(pleat.Run({"decompress", copy, "-o", pleat.File("no.pc2")}).exit_code, 3);
}

}  // namespace
}  // namespace pleat
