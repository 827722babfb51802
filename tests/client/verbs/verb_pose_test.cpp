#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "client/tube_files.h"
#include "pleat/character/pose_evaluator.h"
#include "pleat/formats/sequence_reader.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class PoseVerbTest : public testing::Test {
 protected:
  Outcome PoseTo(const std::string& output, std::vector<std::string> flags = {}) const {
    flags.insert(flags.begin(), {"pose", files_.model_path(), "--motion", files_.motion_path(),
                                 "--force", "-o", files_.File(output)});
    return RunPleat(flags);
  }
  MeshSequence Read(const std::string& name) const {
    return ReadSequence(files_.File(name)).value();
  }

  const TubeFiles files_;
};

TEST_F(PoseVerbTest, FramesAreTheEvaluatorsOfTheLibrary) {
  const Outcome outcome = PoseTo("posed.pseq", {"--json"});
  ASSERT_EQ(outcome.code, ExitCode::kOk) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json["schema"], "pleat.pose/1");
  EXPECT_EQ(json["num_frames"], TubeFiles::kNumMotionFrames);
  EXPECT_EQ(json["num_vertices"], TubeFiles::kNumVertices);
  EXPECT_LE(json["confidence"]["lowest"], json["confidence"]["mean"]);
  const MeshSequence posed = Read("posed.pseq");
  PLEAT_ASSERT_OK_AND_ASSIGN(const Motion motion,
                             ReadMotion(files_.motion_path(), files_.model().skeleton()));
  PoseEvaluator evaluator(ReadModelFile(files_.model_path()).value());
  int num_frames = 0;
  ASSERT_THAT(evaluator.EvaluateClip(motion.track, {},
                                     [&](int t, const EvaluatedFrame& frame) {
                                       EXPECT_EQ(posed.frame(t), frame.positions) << t;
                                       ++num_frames;
                                       return absl::OkStatus();
                                     }),
              IsOk());
  EXPECT_EQ(num_frames, posed.num_frames());
}

TEST_F(PoseVerbTest, SkinnedOnlyLeavesDetailAndConfidenceOut) {
  ASSERT_EQ(PoseTo("hybrid.pseq").code, ExitCode::kOk);
  const Outcome outcome = PoseTo("skinned.pseq", {"--skinned-only"});
  ASSERT_EQ(outcome.code, ExitCode::kOk);
  EXPECT_THAT(outcome.out, Not(HasSubstr("confidence")));
  EXPECT_THAT(PoseTo("hybrid.pseq").out, HasSubstr("; confidence "));
  EXPECT_NE(Read("skinned.pseq").frame(0), Read("hybrid.pseq").frame(0));
}

TEST_F(PoseVerbTest, LongerBonesMakeATallerTube) {
  ASSERT_EQ(PoseTo("a.pseq", {"--skinned-only"}).code, ExitCode::kOk);
  ASSERT_EQ(PoseTo("b.pseq", {"--skinned-only", "--bone-scale", "head=2"}).code, ExitCode::kOk);
  EXPECT_GT(Read("b.pseq").frame(0).row(1).maxCoeff(),
            Read("a.pseq").frame(0).row(1).maxCoeff() + .2f);
}

TEST_F(PoseVerbTest, DracoFramesAreWrittenInBothEncodings) {
  for (const char* encoding : {"mesh", "points"}) {
    const Outcome outcome = PoseTo(encoding, {"--encoding", encoding, "--bits", "14"});
    ASSERT_EQ(outcome.code, ExitCode::kOk) << outcome.err;
    const auto header =
        nlohmann::json::parse(ReadFile(files_.File(encoding) + "/stream.json").value());
    EXPECT_EQ(header.dump().find("\"null\""), std::string::npos);
  }
}

TEST_F(PoseVerbTest, FlagsForAServerAreRefusedHere) {
  for (const char* content : {"control", "parameters"}) {
    const Outcome outcome = PoseTo("x.pseq", {"--content", content});
    EXPECT_EQ(outcome.code, ExitCode::kUsage);
    EXPECT_THAT(outcome.err, HasSubstr("--content is about frames from a server"));
  }
  EXPECT_EQ(PoseTo("x.pseq", {"--bits", "21"}).code, ExitCode::kUsage);
  EXPECT_EQ(PoseTo("x.pseq", {"--encoding", "delta"}).code, ExitCode::kUsage);
}

TEST_F(PoseVerbTest, WrongMotionsModelsAndBonesAreNamed) {
  const Outcome joint = PoseTo("x.pseq", {"--bone-scale", "tail=2"});
  EXPECT_EQ(joint.code, ExitCode::kUsage);
  EXPECT_THAT(joint.err, HasSubstr("no joint is called 'tail'"));
  const Outcome model = RunPleat({"pose", files_.sequence_path() + ".pleat", "--motion",
                                  files_.motion_path(), "-o", files_.File("x.pseq")});
  EXPECT_EQ(model.code, ExitCode::kNotFound);
  const Outcome motion = RunPleat({"pose", files_.model_path(), "--motion", files_.sequence_path(),
                                   "-o", files_.File("x.pseq")});
  EXPECT_EQ(motion.code, ExitCode::kBadInput);
  EXPECT_THAT(motion.err, HasSubstr("tube.pseq"));
}

TEST_F(PoseVerbTest, AServiceInThisProcessGivesTheSameFrames) {
  const std::string trained = files_.File("trained.pleat"), motion = files_.motion_path();
  ASSERT_EQ(files_.TrainInStore({"-q", "-o", trained}).code, ExitCode::kOk);
  ASSERT_EQ(RunPleat({"pose", trained, "--motion", motion, "-o", files_.File("a.pseq")}).code,
            ExitCode::kOk);
  const auto models = nlohmann::json::parse(files_.RunInStore({"models", "--json"}).out);
  const Outcome stored = files_.RunInStore({"pose", models[0]["id"].get<std::string>(), "--motion",
                                            motion, "-o", files_.File("b.pseq")});
  ASSERT_EQ(stored.code, ExitCode::kOk) << stored.err;
  for (int t = 0; t < TubeFiles::kNumMotionFrames; ++t) {
    EXPECT_EQ(Read("a.pseq").frame(t), Read("b.pseq").frame(t)) << t;
  }
}

}  // namespace
}  // namespace pleat
