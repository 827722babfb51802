#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "client/run_pleat.h"
#include "pleat/base/file.h"
#include "pleat/character/placed_joints.h"
#include "pleat/formats/model_file.h"
#include "pleat/formats/sequence_file.h"
#include "support/capsule_figure.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

// A figure that rises by a centimeter per frame, and where its joints are in frame 0.
void WriteFigure(const TemporaryFolder& folder, int num_frames) {
  const CapsuleFigure figure = MakeCapsuleFigure({.cell_m = .03});
  std::vector<Eigen::Matrix3Xf> frames;
  for (int t = 0; t < num_frames; ++t) {
    frames.push_back(figure.mesh.positions.cast<float>());
    frames.back().row(1).array() += .01f * t;
  }
  ASSERT_THAT(WriteSequenceFile(
                  folder.File("figure.pseq"),
                  *MeshSequence::Create(MakeTopology(figure.mesh), frames, {.name = "figure"})),
              IsOk());
  nlohmann::json truth;
  for (int j = 0; j < kNumHumanJoints; ++j) {
    const Eigen::Vector3d p = figure.joints.col(j);
    truth["joints"].push_back(
        {{"name", HumanTemplate().joint(j).name}, {"position_m", {p.x(), p.y(), p.z()}}});
  }
  ASSERT_THAT(WriteFile(folder.File("figure_truth.json"), truth.dump()), IsOk());
}

TEST(RigVerb, TabulatesRigsRefusalsAndTruth) {
  const TemporaryFolder folder;
  WriteFigure(folder, 4);
  ASSERT_THAT(
      WriteSequenceFile(folder.File("horse.pseq"), MakeStillSequence(MakeCapsuleQuadruped(.05))),
      IsOk());
  const Outcome outcome = RunPleat({"rig", folder.File("figure.pseq"), folder.File("horse.pseq"),
                                    "--report", folder.File("r.json"), "--first-frame", "1",
                                    "--truth", folder.File("figure_truth.json"), "--truth", "-"});
  // The horse has no frame 1.
  EXPECT_EQ(outcome.code, ExitCode::kUsage);

  const Outcome both = RunPleat({"rig", folder.File("figure.pseq"), folder.File("horse.pseq"),
                                 "--report", folder.File("r.json"), "--truth",
                                 folder.File("figure_truth.json"), "--truth", "-"});
  EXPECT_EQ(both.code, ExitCode::kRefused);
  EXPECT_THAT(both.out, HasSubstr("refused"));
  EXPECT_THAT(both.err, HasSubstr("1 of 2"));
  const nlohmann::json report = nlohmann::json::parse(ReadFile(folder.File("r.json")).value());
  EXPECT_EQ(report["schema"], "pleat.rig/1");
  const nlohmann::json& figure = report["rigs"][0];
  EXPECT_EQ(figure["is_refused"], false);
  EXPECT_EQ(figure["yaw_degrees"], 0);
  EXPECT_LT(figure["residual"], .03);
  EXPECT_LT(figure["joint_error"]["mean_m"], .05);
  EXPECT_LT(figure["fit"]["rms_percent"], .1);
  EXPECT_LT(figure["fit"]["refined_rms_percent"], .1);
  EXPECT_EQ(figure["joints"].size(), 18);
  EXPECT_EQ(figure["mesh_report"]["closed"], true);
  EXPECT_EQ(report["rigs"][1]["is_refused"], true);
  EXPECT_THAT(report["rigs"][1]["message"].get<std::string>(), HasSubstr("own rig"));
}

TEST(RigVerb, ScoresTheTruthsFrameWhenTheRestFrameIsAnother) {
  const TemporaryFolder folder;
  WriteFigure(folder, 4);
  const Outcome outcome =
      RunPleat({"rig", folder.File("figure.pseq"), "--first-frame", "3", "--json"});
  EXPECT_EQ(outcome.code, ExitCode::kOk) << outcome.err;
  const nlohmann::json report = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(report["rigs"][0]["num_frames"], 1);
  EXPECT_LT(report["rigs"][0]["joint_error"]["mean_m"], .05);
}

TEST(RigVerb, RenderDrawsTheRig) {
  const TemporaryFolder folder;
  WriteFigure(folder, 2);
  const Outcome outcome = RunPleat({"render", folder.File("figure.pseq"), "--rig", "--frames", "1",
                                    "-o", folder.File("rig.png"), "--tile-width", "60"});
  EXPECT_EQ(outcome.code, ExitCode::kOk) << outcome.err;
  EXPECT_TRUE(std::filesystem::exists(folder.File("rig.png")));
  EXPECT_EQ(RunPleat({"render", folder.File("figure.pseq"), "--rig", "--azimuth", "3", "-o",
                      folder.File("rig.png")})
                .code,
            ExitCode::kUsage);
  EXPECT_EQ(RunPleat({"render", folder.File("figure.pseq"), "--rig", "--frames", "7", "--force",
                      "-o", folder.File("rig.png")})
                .code,
            ExitCode::kBadInput);
}

TEST(RigVerb, JointsThatAPersonPlacesStay) {
  const TemporaryFolder folder;
  WriteFigure(folder, 1);
  const Outcome outcome =
      RunPleat({"rig", folder.File("figure.pseq"), "--report", folder.File("r.json"), "--at",
                "leftHand=.5,1.2,.1", "rightFoot=-.2,.1,0"});
  ASSERT_EQ(outcome.code, ExitCode::kOk) << outcome.err;
  const nlohmann::json report = nlohmann::json::parse(ReadFile(folder.File("r.json")).value());
  const nlohmann::json& joints = report["rigs"][0]["joints"];
  EXPECT_NEAR(joints[kLeftHand]["position_m"][0].get<double>(), .5, 1e-6);
  EXPECT_NEAR(joints[kRightFoot]["position_m"][1].get<double>(), .1, 1e-6);
  EXPECT_EQ(RunPleat({"rig", folder.File("figure.pseq"), "--at", "leftHand=1"}).code,
            ExitCode::kUsage);
}

TEST(RigVerb, TrainingTakesThePlacedJointsHereAndInAStore) {
  const TemporaryFolder folder;
  WriteFigure(folder, 4);
  const auto train = [&](const std::string& model, std::vector<std::string> others) {
    std::vector<std::string> arguments = {"train",     folder.File("figure.pseq"),
                                          "--local",   "-q",
                                          "-o",        folder.File(model),
                                          "--learner", "ridge",
                                          "--refine",  "none",
                                          "--at",      "leftHand=.5,1.2,.1"};
    arguments.insert(arguments.end(), others.begin(), others.end());
    const Outcome outcome = RunPleat(arguments);
    ASSERT_EQ(outcome.code, ExitCode::kOk) << outcome.err;
  };
  train("here.pleat", {});
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto model, ReadModelFile(folder.File("here.pleat")));
  EXPECT_TRUE(
      model->skeleton().rest_position(kLeftHand).isApprox(Eigen::Vector3d(.5, 1.2, .1), 1e-6));
  EXPECT_EQ(FormatPlacedJoints(model->options().placed_joints), "leftHand=0.5,1.2,0.1");
  train("stored.pleat", {"--data-dir", folder.File("store")});
  EXPECT_EQ(ReadFile(folder.File("stored.pleat")).value(),
            ReadFile(folder.File("here.pleat")).value());
}

}  // namespace
}  // namespace pleat
