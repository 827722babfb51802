#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "client/tube_files.h"
#include "pleat/sequence_codec/sequence_decoder.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr char kOneGoal[] = "say one of --max-error-mm E, --kg PERCENT and --lossless-at-bits B";

class CompressVerbTest : public testing::Test {
 protected:
  Outcome Compress(std::vector<std::string> flags) const {
    flags.insert(flags.begin(), {"compress", files_.sequence_path(), "--force", "-o", output_});
    return RunPleat(flags);
  }
  MeshSequence Decoded() const {
    return SequenceDecoder::Open(ReadFile(output_).value()).value().DecodeAll().value();
  }

  const TubeFiles files_;
  const std::string output_ = files_.File("tube.plt");
};

TEST_F(CompressVerbTest, ThePromiseIsKeptAndReported) {
  const Outcome outcome =
      Compress({"--max-error-mm", "0.5", "--json", "--report", files_.File("report.json")});
  ASSERT_EQ(outcome.code, ExitCode::kOk) << outcome.err;
  const MeshSequence decoded = Decoded();
  double worst = 0;
  for (int t = 0; t < decoded.num_frames(); ++t) {
    worst = std::max(
        worst,
        (decoded.FrameAsDouble(t) - files_.clip().FrameAsDouble(t)).colwise().norm().maxCoeff());
  }
  EXPECT_LE(1e3 * worst, .5);
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json["schema"], "pleat.compress/1");
  EXPECT_EQ(json["bytes"], ReadFile(output_).value().size());
  EXPECT_EQ(nlohmann::json::parse(ReadFile(files_.File("report.json")).value()), json);
}

TEST_F(CompressVerbTest, TextSaysSizeErrorAndSpeedAndQuietSaysNothingElse) {
  EXPECT_THAT(Compress({"--lossless-at-bits", "12"}).out,
              testing::AllOf(HasSubstr(output_ + ": "), HasSubstr("bits per vertex and frame"),
                             HasSubstr("error: KG")));
  const Outcome quiet = Compress({"--kg", "1", "--quiet"});
  EXPECT_EQ(quiet.code, ExitCode::kOk) << quiet.err;
  EXPECT_THAT(quiet.out, HasSubstr("error: KG"));
  EXPECT_THAT(quiet.err, IsEmpty());
}

TEST_F(CompressVerbTest, ExactlyOneGoalMustBeGiven) {
  for (const std::vector<std::string>& flags : {std::vector<std::string>{},
                                                {"--kg", "1", "--max-error-mm", "1"},
                                                {"--kg", "1", "--lossless-at-bits", "12"}}) {
    const Outcome outcome = Compress(flags);
    EXPECT_EQ(outcome.code, ExitCode::kUsage);
    EXPECT_THAT(outcome.err, HasSubstr(kOneGoal));
  }
}

TEST_F(CompressVerbTest, ValuesOutOfRangeAreUsageErrors) {
  for (const auto& [flag, value] :
       {std::pair("--max-error-mm", "0.0001"), std::pair("--kg", "60"),
        std::pair("--lossless-at-bits", "21"), std::pair("--lossless-at-bits", "7")}) {
    EXPECT_EQ(Compress({flag, value}).code, ExitCode::kUsage) << flag << value;
  }
}

TEST_F(CompressVerbTest, AServiceGivesTheSameFile) {
  ASSERT_EQ(Compress({"--max-error-mm", "1", "--quiet"}).code, ExitCode::kOk);
  const std::string here = ReadFile(output_).value();
  const Outcome stored = files_.RunInStore({"compress", files_.sequence_path(), "--force", "-o",
                                            output_, "--max-error-mm", "1", "--json"});
  ASSERT_EQ(stored.code, ExitCode::kOk) << stored.err;
  EXPECT_EQ(ReadFile(output_).value(), here);
  EXPECT_EQ(nlohmann::json::parse(stored.out)["schema"], "pleat.compress/1");
}

}  // namespace
}  // namespace pleat
