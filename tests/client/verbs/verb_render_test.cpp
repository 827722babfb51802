#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "client/tube_files.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

class RenderVerbTest : public testing::Test {
 protected:
  Outcome Render(std::vector<std::string> inputs, std::vector<std::string> flags) const {
    inputs.insert(inputs.begin(), "render");
    flags.insert(flags.end(),
                 {"--force", "-o", output_, "--tile-width", "48", "--tile-height", "64"});
    inputs.insert(inputs.end(), flags.begin(), flags.end());
    return RunPleat(inputs);
  }
  std::string Png() const { return ReadFile(output_).value_or(""); }
  // The size of a PNG is in its first chunk (big-endian).
  int Width() const { return Number(16); }
  int Height() const { return Number(20); }

  const TubeFiles files_;
  const std::string output_ = files_.File("sheet.png");

 private:
  int Number(size_t at) const {
    const std::string png = Png();
    int number = 0;
    for (size_t i = at; i < at + 4 && i < png.size(); ++i) {
      number = number << 8 | static_cast<unsigned char>(png[i]);
    }
    return number;
  }
};

TEST_F(RenderVerbTest, ASheetHasATileForEveryFrameAndARowForEveryInput) {
  const std::string input = files_.sequence_path();
  const Outcome outcome = Render({input}, {"--count", "3"});
  ASSERT_EQ(outcome.code, ExitCode::kOk) << outcome.err;
  EXPECT_EQ(outcome.out, output_ + "\n");
  EXPECT_THAT(Png(), StartsWith("\x89PNG"));
  const int width = Width(), height = Height();
  EXPECT_GE(width, 3 * 48);
  ASSERT_EQ(Render({input}, {"--frames", "0,4,9,2,3,5"}).code, ExitCode::kOk);
  EXPECT_GE(Width(), width + 3 * 48);
  ASSERT_EQ(Render({input, input}, {"--count", "3", "--label", "a", "--label", "b"}).code,
            ExitCode::kOk);
  EXPECT_GE(Height(), height + 64);
}

TEST_F(RenderVerbTest, JsonNamesThePictureAndWhatTheReaderNoticed) {
  const std::string mesh = files_.File("two.obj");
  ASSERT_THAT(WriteFile(mesh, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2\n"), IsOk());
  // A quotation mark, a line break, and a byte that is not UTF-8.
  const std::string output = files_.File("a\"b\n\xe6.png");
  const Outcome outcome = RunPleat({"render", mesh, "--json", "--count", "1", "-o", output});
  ASSERT_EQ(outcome.code, ExitCode::kOk) << outcome.err;
  EXPECT_THAT(ReadFile(output).value(), StartsWith("\x89PNG"));
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json["schema"], "pleat.render/1");
  EXPECT_EQ(json["output"], files_.File("a\"b\n\uFFFD.png"));
  ASSERT_EQ(json["input_notes"].size(), 1u);
  EXPECT_EQ(json["input_notes"][0]["kind"], "faces_left_out");
}

TEST_F(RenderVerbTest, TheViewerCanStandElsewhere) {
  ASSERT_EQ(Render({files_.sequence_path()}, {"--count", "2"}).code, ExitCode::kOk);
  const std::string front = Png();
  ASSERT_EQ(Render({files_.sequence_path()}, {"--count", "2"}).code, ExitCode::kOk);
  EXPECT_EQ(Png(), front);  // the same input, the same picture
  ASSERT_EQ(Render({files_.sequence_path()}, {"--count", "2", "--azimuth", "70"}).code,
            ExitCode::kOk);
  EXPECT_NE(Png(), front);
}

TEST_F(RenderVerbTest, AModelAddsTwoRows) {
  ASSERT_EQ(Render({files_.sequence_path()}, {"--count", "2"}).code, ExitCode::kOk);
  const int height = Height();
  const Outcome outcome =
      Render({files_.sequence_path()}, {"--count", "2", "--model", files_.model_path()});
  ASSERT_EQ(outcome.code, ExitCode::kOk) << outcome.err;
  EXPECT_GE(Height(), height + 2 * 64);
}

TEST_F(RenderVerbTest, ComparisonsAndRigsAreDrawn) {
  const Outcome compared =
      Render({files_.sequence_path(), files_.model_path()}, {"--compare", "--count", "2"});
  ASSERT_EQ(compared.code, ExitCode::kOk) << compared.err;
  const std::string comparison = Png();
  EXPECT_THAT(comparison, StartsWith("\x89PNG"));
  const Outcome rig = Render({files_.model_path()}, {"--rig"});
  ASSERT_EQ(rig.code, ExitCode::kOk) << rig.err;
  EXPECT_THAT(Png(), StartsWith("\x89PNG"));
  EXPECT_NE(Png(), comparison);
}

TEST_F(RenderVerbTest, FlagsThatDoNotGoTogetherAreUsageErrors) {
  const std::string input = files_.sequence_path(), model = files_.model_path();
  for (const auto& [outcome, reason] :
       {std::pair(Render({input}, {"--label", "a", "--label", "b"}), "more --label than inputs"),
        std::pair(Render({input}, {"--compare"}), "--compare takes two inputs"),
        std::pair(Render({input, model}, {"--compare", "--rig"}), "--compare takes two inputs"),
        std::pair(Render({model}, {"--rig", "--azimuth", "3"}), "--rig goes with neither"),
        std::pair(Render({input}, {"--frames", "1", "--count", "2"}), "--frames")}) {
    EXPECT_EQ(outcome.code, ExitCode::kUsage) << reason;
    EXPECT_THAT(outcome.err, HasSubstr(reason));
  }
  EXPECT_EQ(Png(), "");
}

TEST_F(RenderVerbTest, FramesThatAreNotThereAreNamedWithTheCount) {
  const Outcome outcome =
      Render({files_.sequence_path(), files_.model_path()}, {"--compare", "--frames", "0,10"});
  EXPECT_EQ(outcome.code, ExitCode::kBadInput);
  EXPECT_THAT(outcome.err, HasSubstr("'tube' has no frame 10: it has 10 frames, from 0"));
}

}  // namespace
}  // namespace pleat
