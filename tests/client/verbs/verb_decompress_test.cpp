#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "client/tube_files.h"
#include "pleat/formats/sequence_reader.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

class DecompressVerbTest : public testing::Test {
 protected:
  void SetUp() override {
    const Outcome made = RunPleat(
        {"compress", files_.sequence_path(), "-o", path_, "--max-error-mm", "0.1", "--quiet"});
    ASSERT_EQ(made.code, ExitCode::kOk) << made.err;
  }
  Outcome Decompress(std::vector<std::string> flags) const {
    flags.insert(flags.begin(), {"decompress", path_, "--force", "-o", output_});
    return RunPleat(flags);
  }
  MeshSequence Written() const { return ReadSequence(output_).value(); }

  const TubeFiles files_;
  const std::string path_ = files_.File("tube.plt"), output_ = files_.File("out.pseq");
};

TEST_F(DecompressVerbTest, FramesNameAndRateComeBack) {
  const Outcome outcome = Decompress({"--json"});
  ASSERT_EQ(outcome.code, ExitCode::kOk) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json["schema"], "pleat.decompress/1");
  EXPECT_EQ(json["num_frames"], TubeFiles::kNumFrames);
  EXPECT_EQ(json["num_vertices"], TubeFiles::kNumVertices);
  const MeshSequence written = Written();
  EXPECT_TRUE(written.topology() == files_.clip().topology());
  EXPECT_EQ(written.frame_rate(), files_.clip().frame_rate());
  for (int t = 0; t < TubeFiles::kNumFrames; ++t) {
    EXPECT_LE((written.frame(t) - files_.clip().frame(t)).colwise().norm().maxCoeff(), 1.01e-4f);
  }
}

TEST_F(DecompressVerbTest, RangesGiveTheFramesOfTheWhole) {
  ASSERT_EQ(Decompress({"-q"}).code, ExitCode::kOk);
  const MeshSequence all = Written();
  for (const auto& [text, begin, end] :
       {std::tuple("3:7", 3, 7), std::tuple("8:", 8, 10), std::tuple(":2", 0, 2),
        std::tuple(":", 0, 10), std::tuple("9:10", 9, 10)}) {
    const Outcome outcome = Decompress({"--frames", text, "--json"});
    ASSERT_EQ(outcome.code, ExitCode::kOk) << text << outcome.err;
    EXPECT_EQ(nlohmann::json::parse(outcome.out)["first_frame"], begin) << text;
    const MeshSequence part = Written();
    ASSERT_EQ(part.num_frames(), end - begin) << text;
    for (int t = begin; t < end; ++t) EXPECT_EQ(part.frame(t - begin), all.frame(t)) << text;
  }
}

TEST_F(DecompressVerbTest, RangesThatAreNoneAreToldHowToWriteThem) {
  for (const char* text : {"3", "a:b", "1:2:3", "1-2", "1:x"}) {
    const Outcome outcome = Decompress({"--frames", text});
    EXPECT_EQ(outcome.code, ExitCode::kUsage) << text;
    EXPECT_THAT(outcome.err, HasSubstr("write a:b for the frames a to b - 1")) << text;
  }
  for (const char* text : {"5:5", "7:3"}) {
    const Outcome outcome = Decompress({"--frames", text});
    EXPECT_EQ(outcome.code, ExitCode::kBadInput) << text;
    EXPECT_THAT(outcome.err, HasSubstr("which holds no frame")) << text;
  }
  EXPECT_EQ(Decompress({"--frames", "5:11"}).code, ExitCode::kBadInput);
}

TEST_F(DecompressVerbTest, OtherFilesAreNamedWithTheReason) {
  const Outcome other = RunPleat({"decompress", files_.model_path(), "-o", output_});
  EXPECT_EQ(other.code, ExitCode::kBadInput);
  EXPECT_THAT(other.err,
              testing::AllOf(HasSubstr("tube.pleat: "), HasSubstr("compressed sequence")));
  const Outcome missing = RunPleat({"decompress", files_.File("none.plt"), "-o", output_});
  EXPECT_EQ(missing.code, ExitCode::kNotFound);
  EXPECT_THAT(missing.err, HasSubstr("none.plt"));
}

TEST_F(DecompressVerbTest, AServiceDecodesUploadedFilesAndStoredIds) {
  ASSERT_EQ(Decompress({"-q"}).code, ExitCode::kOk);
  const std::string here = ReadFile(output_).value();
  const Outcome uploaded = files_.RunInStore({"decompress", path_, "--force", "-o", output_, "-q"});
  ASSERT_EQ(uploaded.code, ExitCode::kOk) << uploaded.err;
  EXPECT_EQ(ReadFile(output_).value(), here);
  const auto list = nlohmann::json::parse(files_.RunInStore({"compressed", "--json"}).out);
  ASSERT_EQ(list.size(), 1u);
  const Outcome stored = files_.RunInStore({"decompress", list[0]["id"].get<std::string>(),
                                            "--force", "-o", output_, "--frames", "2:4", "-q"});
  ASSERT_EQ(stored.code, ExitCode::kOk) << stored.err;
  EXPECT_EQ(Written().num_frames(), 2);
}

}  // namespace
}  // namespace pleat
