#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "client/tube_files.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

class TrainVerbTest : public testing::Test {
 protected:
  // In this process, without a store.
  Outcome TrainHere(std::vector<std::string> flags) const {
    flags.insert(flags.begin(), {"train", files_.sequence_path(), "--local", "--rig",
                                 files_.rig_path(), "--learner", "ridge", "--refine", "none"});
    return RunPleat(flags);
  }

  const TubeFiles files_;
  const std::string model_ = files_.File("out.pleat");
};

TEST_F(TrainVerbTest, WritesAModelAndAReportThatAgree) {
  const Outcome outcome =
      TrainHere({"-o", model_, "--report", files_.File("report.json"), "--json"});
  ASSERT_EQ(outcome.code, ExitCode::kOk) << outcome.err;
  const auto report = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(report["schema"], "pleat.train/1");
  EXPECT_EQ(nlohmann::json::parse(ReadFile(files_.File("report.json")).value()), report);
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto model, ReadModelFile(model_));
  EXPECT_EQ(model->record().learner, "ridge");
  EXPECT_EQ(model->num_vertices(), TubeFiles::kNumVertices);
  EXPECT_EQ(model->skeleton().joint(2).name, "head");
  EXPECT_EQ(report["rig"]["joints"].size(), 3u);
}

TEST_F(TrainVerbTest, HereAndThroughAStoreTheModelHasTheSameBytes) {
  ASSERT_EQ(TrainHere({"-o", model_, "-q"}).code, ExitCode::kOk);
  const std::string stored = files_.File("stored.pleat");
  ASSERT_EQ(files_.TrainInStore({"-o", stored, "-q"}).code, ExitCode::kOk);
  EXPECT_EQ(ReadFile(model_).value(), ReadFile(stored).value());
}

TEST_F(TrainVerbTest, ThreadsDoNotChangeTheBytes) {
  ASSERT_EQ(TrainHere({"-o", model_, "-q", "--threads", "1"}).code, ExitCode::kOk);
  const std::string other = files_.File("other.pleat");
  ASSERT_EQ(TrainHere({"-o", other, "-q", "--threads", "3"}).code, ExitCode::kOk);
  EXPECT_EQ(ReadFile(model_).value(), ReadFile(other).value());
}

TEST_F(TrainVerbTest, TextTabulatesErrorsAndSaysWhereToLook) {
  const Outcome outcome = TrainHere({"-o", model_});
  ASSERT_EQ(outcome.code, ExitCode::kOk) << outcome.err;
  for (const char* part : {"learner ridge", "skinned only", "hybrid",
                           "worst frames, skinned only:", "worst bones:", "out.pleat, "}) {
    EXPECT_THAT(outcome.out, HasSubstr(part));
  }
}

TEST_F(TrainVerbTest, CommandLinesThatLackSomethingAreUsageErrors) {
  const std::string input = files_.sequence_path();
  for (const auto& [arguments, reason] :
       {std::pair(std::vector<std::string>{"train", input, "--local"},
                  "--local without --data-dir needs -o FILE"),
        std::pair(std::vector<std::string>{"train", input, "--lock", "head", "-o", model_},
                  "--lock needs --rig"),
        std::pair(std::vector<std::string>{"train", input, "--local", "--skin", "1", "-o", model_},
                  "--skin chooses"),
        std::pair(std::vector<std::string>{"train", input, "--local", "-o", model_, "--rig",
                                           files_.rig_path(), "--at", "head=0,1,0"},
                  "--at places"),
        std::pair(std::vector<std::string>{"train", input, "--local", "-o", model_, "--at", "head"},
                  "x,y,z"),
        std::pair(std::vector<std::string>{"train", input, "--local", "--detach", "-o", model_},
                  "--detach needs a server"),
        std::pair(
            std::vector<std::string>{"train", input, "--local", "-o", model_, "--learner", "magic"},
            "learner")}) {
    const Outcome outcome = RunPleat(arguments);
    EXPECT_EQ(outcome.code, ExitCode::kUsage) << reason;
    EXPECT_THAT(outcome.err, HasSubstr(reason));
  }
}

TEST_F(TrainVerbTest, OneFrameIsNoClip) {
  ASSERT_THAT(WriteSequenceFile(files_.File("one.pseq"), MakeSwayingTube(1)), IsOk());
  for (const char* verb : {"train", "evaluate"}) {
    std::vector<std::string> arguments = {verb, files_.File("one.pseq"), "--local"};
    if (verb == std::string("train")) arguments.insert(arguments.end(), {"-o", model_});
    const Outcome outcome = RunPleat(arguments);
    EXPECT_EQ(outcome.code, ExitCode::kBadInput) << verb;
    EXPECT_THAT(outcome.err, HasSubstr("one.pseq' is one frame; a clip needs two frames")) << verb;
  }
}

TEST_F(TrainVerbTest, WithoutAServerTheOtherWayIsNamed) {
  const Outcome outcome =
      RunPleat({"train", files_.sequence_path(), "--server", "127.0.0.1:1", "-o", model_});
  EXPECT_EQ(outcome.code, ExitCode::kUnavailable);
  EXPECT_THAT(outcome.err, HasSubstr("--local trains in this process"));
}

TEST_F(TrainVerbTest, QuietKeepsTheResult) {
  const Outcome outcome = TrainHere({"-o", model_, "-q"});
  EXPECT_THAT(outcome.out, HasSubstr("learner ridge"));
  EXPECT_EQ(outcome.err, "");
}

TEST_F(TrainVerbTest, RigsThatDoNotFitAreRefusedByName) {
  EXPECT_THAT(TrainHere({"-o", model_, "--lock", "tail"}).err, HasSubstr("tail"));
  const MeshSequence other = MakeSwayingTube(3, "other", 5, 4);
  ASSERT_THAT(WriteSequenceFile(files_.File("other.pseq"), other), IsOk());
  const Outcome outcome = RunPleat(
      {"train", files_.File("other.pseq"), "--local", "--rig", files_.rig_path(), "-o", model_});
  EXPECT_EQ(outcome.code, ExitCode::kBadInput);
  EXPECT_THAT(outcome.err, HasSubstr("vertices"));
  EXPECT_EQ(RunPleat({"train", files_.sequence_path(), "--local", "--rig", files_.File("none.json"),
                      "-o", model_})
                .code,
            ExitCode::kNotFound);
}

TEST_F(TrainVerbTest, ClipsOfAnotherConnectivityAreRefused) {
  const MeshSequence other = MakeSwayingTube(3, "other", 5, 4);
  ASSERT_THAT(WriteSequenceFile(files_.File("other.pseq"), other), IsOk());
  const Outcome outcome = TrainHere({files_.File("other.pseq"), "-o", model_});
  EXPECT_EQ(outcome.code, ExitCode::kBadInput);
  EXPECT_FALSE(std::filesystem::exists(model_));
}

TEST_F(TrainVerbTest, ClipsThatJumpAreRefusedHereAndInAStoreUnlessAllowed) {
  std::vector<Eigen::Matrix3Xf> frames;
  for (int t = 0; t < files_.clip().num_frames(); ++t) frames.push_back(files_.clip().frame(t));
  frames[4] *= 10;
  ASSERT_THAT(WriteSequenceFile(files_.sequence_path(),
                                MeshSequence::Create(files_.clip().topology(), frames).value()),
              IsOk());
  for (const Outcome& refused : {TrainHere({"-o", model_}), files_.TrainInStore({"-o", model_})}) {
    EXPECT_EQ(refused.code, ExitCode::kRefused);
    EXPECT_THAT(refused.err, HasSubstr("warning: frame 4 is "));
    EXPECT_THAT(refused.err, HasSubstr("--allow-jumps"));
  }
  EXPECT_NE(TrainHere({"-o", model_, "--allow-jumps"}).code, ExitCode::kRefused);
}

}  // namespace
}  // namespace pleat
