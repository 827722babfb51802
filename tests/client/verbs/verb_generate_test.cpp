#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "client/run_pleat.h"
#include "pleat/base/file.h"
#include "pleat/formats/sequence_reader.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

class GenerateVerbTest : public testing::Test {
 protected:
  Outcome Generate(const std::string& folder, std::vector<std::string> flags) const {
    flags.insert(flags.begin(), {"generate", "performer", "-o", folder_.File(folder), "--frames",
                                 "4", "--vertices", "500"});
    return RunPleat(flags);
  }
  std::string Contents(const std::string& path) const {
    return ReadFile(folder_.File(path)).value_or("");
  }

  const TemporaryFolder folder_;
};

TEST_F(GenerateVerbTest, WritesTheSequenceItsTruthAndItsMotion) {
  const Outcome outcome =
      Generate("a", {"--format", "pseq", "--fps", "24", "--height", "1.5", "--json"});
  ASSERT_EQ(outcome.code, ExitCode::kOk) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json["schema"], "pleat.generate/1");
  EXPECT_EQ(json["num_frames"], 4);
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence sequence,
                             ReadSequence(json["sequence"].get<std::string>()));
  EXPECT_EQ(sequence.num_frames(), 4);
  EXPECT_EQ(sequence.num_vertices(), json["num_vertices"]);
  EXPECT_NEAR(sequence.num_vertices(), 500, 150);
  EXPECT_EQ(sequence.frame_rate().fps(), 24);
  const auto truth = nlohmann::json::parse(Contents("a/truth.json"));
  EXPECT_EQ(truth["schema"], "pleat.performer_truth/1");
  EXPECT_EQ(truth["joints"].size(), 18u);
  EXPECT_GT(truth["skirt_vertices"].size(), 10u);
  for (const auto& v : truth["skirt_vertices"]) EXPECT_LT(v, sequence.num_vertices());
  EXPECT_EQ(nlohmann::json::parse(Contents("a/motion.json"))["fps"], 24);
}

TEST_F(GenerateVerbTest, SeedsDecideMotionAndBodySeparately) {
  ASSERT_EQ(Generate("a", {}).code, ExitCode::kOk);
  ASSERT_EQ(Generate("b", {}).code, ExitCode::kOk);
  EXPECT_EQ(Contents("a/performer.pc2"), Contents("b/performer.pc2"));
  ASSERT_EQ(Generate("c", {"--seed", "5"}).code, ExitCode::kOk);
  EXPECT_NE(Contents("c/motion.json"), Contents("a/motion.json"));
  // The same body: the same faces.
  EXPECT_EQ(ReadSequence(folder_.File("c/performer.pc2"))->topology(),
            ReadSequence(folder_.File("a/performer.pc2"))->topology());
}

TEST_F(GenerateVerbTest, TextNamesTheFiles) {
  EXPECT_THAT(Generate("a", {"--style", "walk"}).out,
              testing::AllOf(HasSubstr("performer.pc2: 4 frames of "), HasSubstr("truth.json"),
                             HasSubstr("motion.json")));
}

TEST_F(GenerateVerbTest, RefusesWhatItCannotMake) {
  EXPECT_EQ(RunPleat({"generate", "horse", "-o", folder_.path()}).code, ExitCode::kUsage);
  EXPECT_EQ(Generate("a", {"--style", "swim"}).code, ExitCode::kUsage);
  EXPECT_EQ(Generate("a", {"--fps", "never"}).code, ExitCode::kUsage);
  EXPECT_EQ(Generate("a", {"--format", "gif"}).code, ExitCode::kUsage);
  const Outcome frames = RunPleat({"generate", "performer", "-o", folder_.path(), "--frames", "0"});
  EXPECT_EQ(frames.code, ExitCode::kBadInput);
  EXPECT_THAT(frames.err, HasSubstr("frames"));
}

}  // namespace
}  // namespace pleat
