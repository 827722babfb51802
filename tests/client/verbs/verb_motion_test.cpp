#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "client/tube_files.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

class MotionVerbTest : public testing::Test {
 protected:
  Outcome Edit(const std::string& source, std::vector<std::string> flags) const {
    flags.insert(flags.begin(), {"motion", files_.model_path(), source, "--force", "-o", output_});
    return RunPleat(flags);
  }
  Motion Read(const std::string& path) const {
    return ReadMotion(path, files_.model().skeleton()).value();
  }

  const TubeFiles files_;
  const std::string output_ = files_.File("edited.json");
};

TEST_F(MotionVerbTest, WithoutEditsAMotionComesBack) {
  const Outcome outcome = Edit(files_.motion_path(), {"--json"});
  ASSERT_EQ(outcome.code, ExitCode::kOk) << outcome.err;
  EXPECT_EQ(nlohmann::json::parse(outcome.out),
            (nlohmann::json{{"schema", "pleat.motion_written/1"},
                            {"output", output_},
                            {"num_frames", TubeFiles::kNumMotionFrames},
                            {"num_joints", 3}}));
  const Motion before = Read(files_.motion_path()), after = Read(output_);
  ASSERT_EQ(after.track.num_frames(), before.track.num_frames());
  for (int t = 0; t < after.track.num_frames(); ++t) {
    const Pose &a = after.track.pose(t), &b = before.track.pose(t);
    EXPECT_LT((a.root_position - b.root_position).norm(), 1e-9);
    for (size_t j = 0; j < a.rotations.size(); ++j) {
      EXPECT_LT(a.rotations[j].angularDistance(b.rotations[j]), 1e-6);
    }
  }
}

TEST_F(MotionVerbTest, TheMotionOfASequenceIsItsPoses) {
  ASSERT_EQ(Edit(files_.sequence_path(), {}).code, ExitCode::kOk);
  EXPECT_EQ(Read(output_).track.num_frames(), TubeFiles::kNumFrames);
}

TEST_F(MotionVerbTest, TheMotionOfASequenceCanBeEditedWithoutTheModel) {
  ASSERT_EQ(Edit(files_.sequence_path(), {}).code, ExitCode::kOk);
  const Outcome edit = RunPleat({"motion", "edit", output_, "--detail", "all=.5"});
  ASSERT_EQ(edit.code, ExitCode::kOk) << edit.err;
  // What it says of the detail stays, whatever is done to it.
  const std::string again = files_.File("again.json");
  ASSERT_EQ(RunPleat({"motion", files_.model_path(), output_, "-o", again}).code, ExitCode::kOk);
  // That of the root is not used.
  EXPECT_THAT(Read(again).detail_strengths, testing::ElementsAre(1, .5, .5));
}

TEST_F(MotionVerbTest, EditsAreAppliedAndBoneLengthsKept) {
  const Outcome outcome =
      Edit(files_.motion_path(), {"--offset-root", "0,1,0", "--time-scale", "2", "--bone-scale",
                                  "head=1.25", "--scale-rotation", "all=0"});
  ASSERT_EQ(outcome.code, ExitCode::kOk) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("edited.json: "));
  const Motion before = Read(files_.motion_path()), after = Read(output_);
  EXPECT_GT(after.track.num_frames(), before.track.num_frames() + 3);
  EXPECT_NEAR(after.track.pose(0).root_position.y(), before.track.pose(0).root_position.y() + 1,
              1e-9);
  ASSERT_EQ(after.bone_scales.size(), 3u);
  EXPECT_EQ(after.bone_scales[2], 1.25);
  for (size_t j = 1; j < 3; ++j) {
    EXPECT_LT(after.track.pose(2).rotations[j].angularDistance(Eigen::Quaterniond::Identity()),
              1e-6);
  }
}

TEST_F(MotionVerbTest, BoneLengthsOfTheSourceStayUnlessGiven) {
  ASSERT_EQ(Edit(files_.motion_path(), {"--bone-scale", "head=1.25"}).code, ExitCode::kOk);
  const std::string first = files_.File("first.json");
  ASSERT_THAT(WriteFile(first, ReadFile(output_).value()), IsOk());
  ASSERT_EQ(Edit(first, {}).code, ExitCode::kOk);
  EXPECT_EQ(Read(output_).bone_scales[2], 1.25);
  ASSERT_EQ(Edit(first, {"--bone-scale", "chest=2"}).code, ExitCode::kOk);
  EXPECT_EQ(Read(output_).bone_scales[1], 2);
  EXPECT_EQ(Read(output_).bone_scales[2], 1);
}

TEST_F(MotionVerbTest, EditsThatAreWrongNameTheirText) {
  for (const auto& [flag, text, reason] :
       {std::tuple("--scale-rotation", "tail=2", "no joint is called 'tail'"),
        std::tuple("--scale-rotation", "head", "'head' is not JOINT=VALUE"),
        std::tuple("--scale-rotation", "head=much", "'much' is not a number"),
        std::tuple("--offset-rotation", "head=1,2", "is not three numbers x,y,z"),
        std::tuple("--time-scale", "0.001", "outside 0.01 to 100")}) {
    const Outcome outcome = Edit(files_.motion_path(), {flag, text});
    EXPECT_EQ(outcome.code, ExitCode::kUsage) << flag << text;
    EXPECT_THAT(outcome.err, HasSubstr(reason)) << flag;
  }
  EXPECT_FALSE(std::filesystem::exists(output_));
}

TEST_F(MotionVerbTest, WhatIsNoMotionIsBadInput) {
  ASSERT_THAT(WriteFile(files_.File("broken.json"), "{\"fps\": 25"), IsOk());
  const Outcome outcome = Edit(files_.File("broken.json"), {});
  EXPECT_EQ(outcome.code, ExitCode::kBadInput);
  EXPECT_THAT(outcome.err, HasSubstr("broken.json"));
}

}  // namespace
}  // namespace pleat
