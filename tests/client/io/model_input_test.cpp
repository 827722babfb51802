#include "cli/io/model_input.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "cli/exit_code.h"
#include "client/tube_files.h"
#include "pleat/skeleton/human_template.h"

namespace pleat {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class ModelInputTest : public testing::Test {
 protected:
  void SetUp() override {
    session_.out = &out_;
    session_.err = &err_;
    session_.local = true;
    session_.data_dir = files_.File("store");
  }

  const TubeFiles files_;
  std::ostringstream out_, err_;
  Session session_;
};

TEST_F(ModelInputTest, FilesAreToldFromIdsByEndingOrExistence) {
  EXPECT_TRUE(IsModelFile("not/there.pleat"));
  EXPECT_TRUE(IsModelFile(files_.motion_path()));  // exists: the reader will say what it is
  EXPECT_FALSE(IsModelFile("4f2a"));
}

TEST_F(ModelInputTest, ModelFilesAreRead) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto model, LoadModel(session_, files_.model_path()));
  EXPECT_EQ(EncodeModel(*model), EncodeModel(files_.model()));
  EXPECT_EQ(ExitCodeOf(LoadModel(session_, files_.File("none.pleat")).status()),
            ExitCode::kNotFound);
  EXPECT_EQ(ExitCodeOf(LoadModel(session_, files_.motion_path()).status()), ExitCode::kBadInput);
}

TEST_F(ModelInputTest, ModelsOfAServiceAreFoundByTheirFirstDigits) {
  EXPECT_THAT(LoadModel(session_, "4f2a"),
              HasStatus(absl::StatusCode::kNotFound, "there is no model 4f2a"));
  const Outcome trained = files_.TrainInStore({"--quiet", "-o", files_.File("trained.pleat")});
  ASSERT_EQ(trained.code, ExitCode::kOk) << trained.err;
  const std::string bytes = ReadFile(files_.File("trained.pleat")).value();
  const auto models = nlohmann::json::parse(files_.RunInStore({"models", "--json"}).out);
  ASSERT_EQ(models.size(), 1u);
  const std::string id = models[0]["id"];
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto model, LoadModel(session_, id.substr(0, 5)));
  EXPECT_EQ(EncodeModel(*model), bytes);
}

TEST_F(ModelInputTest, MotionsComeFromMotionFilesAndFromSequences) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const Motion file,
                             LoadMotion(files_.motion_path(), "", files_.model(), session_));
  EXPECT_EQ(file.track.num_frames(), TubeFiles::kNumMotionFrames);
  PLEAT_ASSERT_OK_AND_ASSIGN(const Motion fitted,
                             LoadMotion(files_.sequence_path(), "", files_.model(), session_));
  EXPECT_EQ(fitted.track.num_frames(), TubeFiles::kNumFrames);
  EXPECT_DOUBLE_EQ(fitted.track.fps(), 25);
}

TEST_F(ModelInputTest, AnotherConnectivityIsRefused) {
  const MeshSequence other = MakeSwayingTube(2, "other", 5, 4);
  ASSERT_THAT(WriteSequenceFile(files_.File("other.pseq"), other), IsOk());
  const absl::Status status =
      LoadMotion(files_.File("other.pseq"), "", files_.model(), session_).status();
  EXPECT_EQ(ExitCodeOf(status), ExitCode::kBadInput);
  EXPECT_THAT(std::string(status.message()), HasSubstr("connectivity"));
}

TEST_F(ModelInputTest, JointNamesKeepTheOrderOfTheSkeleton) {
  EXPECT_THAT(JointNames(files_.model().skeleton()), ElementsAre("hips", "chest", "head"));
  EXPECT_EQ(JointNames(HumanTemplate()).size(), 18u);
}

}  // namespace
}  // namespace pleat
