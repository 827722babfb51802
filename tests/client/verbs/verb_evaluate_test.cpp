// Experiments and heat maps as a user calls them, on a small generated performer.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "client/run_pleat.h"
#include "pleat/base/file.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

class EvaluateVerb : public ::testing::Test {
 protected:
  void SetUp() override {
    input_ = folder_.File("performer.pc2");
    const Outcome made = RunPleat({"generate", "performer", "-o", folder_.path(), "--frames", "40",
                                   "--vertices", "700", "--quiet"});
    ASSERT_EQ(made.code, ExitCode::kOk) << made.err;
  }

  const TemporaryFolder folder_;
  std::string input_;
};

TEST_F(EvaluateVerb, WritesTablesAndPlotsOfAnExperiment) {
  const std::string out = folder_.File("figures");
  const Outcome outcome = RunPleat(
      {"evaluate", input_, "--experiment", "representations", "--out", out, "--iterations", "5"});
  ASSERT_EQ(outcome.code, ExitCode::kOk) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("Euler angles"));
  const auto json = nlohmann::json::parse(ReadFile(out + "/representations.json").value());
  EXPECT_EQ(json["schema"], "pleat.experiment/1");
  EXPECT_EQ(json["preset"], "paper");
  ASSERT_EQ(json["rows"].size(), 7u);
  for (const auto& row : json["rows"]) {
    EXPECT_EQ(row["protocol"], "reconstruct");
    EXPECT_EQ(row["learner"], "sgplvm");
    EXPECT_EQ(row["options"]["fit"], "walk");
    EXPECT_EQ(row["frame_mean_percent"]["hybrid"].size(), 40u);
  }
  EXPECT_THAT(ReadFile(out + "/representations.md").value(),
              HasSubstr("](representations-details.png)"));
  for (const char* name : {"/representations-rotations.png", "/representations-details.png"}) {
    EXPECT_THAT(ReadFile(out + name).value(), StartsWith("\x89PNG")) << name;
  }
}

TEST_F(EvaluateVerb, TakesAnyLearnerAndProtocolForAnExperiment) {
  const std::string out = folder_.File("figures");
  const Outcome outcome =
      RunPleat({"evaluate", input_, "--experiment", "skinned-vs-hybrid", "--out", out, "--preset",
                "default", "--learner", "ridge", "--measure", "gp", "--protocol", "blocks10",
                "--refine", "none", "--json"});
  ASSERT_EQ(outcome.code, ExitCode::kOk) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  ASSERT_EQ(json["rows"].size(), 1u);
  const auto& row = json["rows"][0];
  EXPECT_EQ(row["learner"], "ridge");
  EXPECT_EQ(row["protocol"], "blocks10");
  EXPECT_EQ(row["frame_mean_percent"]["learners"]["gp"].size(), row["test_frames"].size());
  EXPECT_GT(row["motion"]["learners"]["gp"]["jitter_mm"], 0);
  EXPECT_GT(row["motion"]["baselines"]["nearest"]["mean_mm"], 0);
  EXPECT_TRUE(std::filesystem::exists(out + "/skinned-vs-hybrid.png"));
}

TEST_F(EvaluateVerb, FlagsThatDoNotGoTogetherAreUsageErrors) {
  for (const std::vector<std::string>& flags :
       {std::vector<std::string>{"--experiment", "resolutions"},
        {"--out", "x"},
        {"--experiment", "figure-9", "--out", "x"},
        {"--experiment", "resolutions", "--out", "x", "--test", "y"}}) {
    std::vector<std::string> arguments = {"evaluate", input_};
    arguments.insert(arguments.end(), flags.begin(), flags.end());
    EXPECT_EQ(RunPleat(arguments).code, ExitCode::kUsage);
  }
}

TEST_F(EvaluateVerb, RenderComparesAModelWithItsInput) {
  const std::string model = folder_.File("model.pleat"), png = folder_.File("heat.png");
  const Outcome trained = RunPleat({"train", input_, "--local", "-o", model, "--learner", "gp",
                                    "--report", folder_.File("train.json")});
  ASSERT_EQ(trained.code, ExitCode::kOk) << trained.err;
  const Outcome drawn =
      RunPleat({"render", input_, model, "--compare", "--scale-mm", "10", "-o", png});
  ASSERT_EQ(drawn.code, ExitCode::kOk) << drawn.err;
  EXPECT_THAT(ReadFile(png).value(), StartsWith("\x89PNG"));
  EXPECT_EQ(
      RunPleat({"render", input_, model, "--compare", "--frames", "40", "--force", "-o", png}).code,
      ExitCode::kBadInput);
  for (const std::vector<std::string>& wrong : {std::vector<std::string>{"render", input_},
                                                {"render", input_, model, "--rig"},
                                                {"render", input_, model, model}}) {
    std::vector<std::string> arguments = wrong;
    arguments.insert(arguments.end(), {"--compare", "-o", png});
    EXPECT_EQ(RunPleat(arguments).code, ExitCode::kUsage);
  }
  // Nothing was held out for a learner that was asked for.
  EXPECT_TRUE(
      nlohmann::json::parse(ReadFile(folder_.File("train.json")).value())["validation"].is_null());
}

}  // namespace
}  // namespace pleat
