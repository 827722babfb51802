#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "client/tube_files.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

class MotionEditVerbTest : public testing::Test {
 protected:
  MotionEditVerbTest() { EXPECT_THAT(WriteFile(path_, before_), IsOk()); }
  Outcome Edit(std::vector<std::string> flags) const {
    flags.insert(flags.begin(), {"motion", "edit", path_});
    return RunPleat(flags);
  }
  std::string Text() const { return ReadFile(path_).value(); }

  const TubeFiles files_;
  const std::string before_ = ReadFile(files_.motion_path()).value();
  const std::string path_ = files_.File("edited.json");
};

TEST_F(MotionEditVerbTest, EditsAreAppliedInTheOrderOfTheirFlagsAndUndone) {
  const Outcome first = Edit({"--model", files_.model_path(), "--offset-root", "0,1,0",
                              "--time-scale", "2", "--offset-root", "0,2,0", "--json"});
  ASSERT_EQ(first.code, ExitCode::kOk) << first.err;
  const auto json = nlohmann::json::parse(first.out);
  EXPECT_EQ(json["schema"], "pleat.motion_edits/1");
  ASSERT_EQ(json["edits"].size(), 3u);
  EXPECT_EQ(json["edits"][0], "offset_root 0,1,0");
  EXPECT_EQ(json["edits"][1], "time_scale 2");
  EXPECT_EQ(json["edits"][2], "offset_root 0,2,0");
  PLEAT_ASSERT_OK_AND_ASSIGN(const Motion source,
                             ReadMotion(files_.motion_path(), files_.model().skeleton()));
  PLEAT_ASSERT_OK_AND_ASSIGN(const Motion motion, ReadMotion(path_, files_.model().skeleton()));
  EXPECT_NEAR(motion.track.pose(0).root_position.y(), source.track.pose(0).root_position.y() + 3,
              1e-9);
  EXPECT_EQ(motion.track.num_frames(), 2 * TubeFiles::kNumMotionFrames - 1);

  // The file holds the skeleton now.
  const std::string edited = Text();
  const Outcome second = Edit({"--detail", "head=.5"});
  ASSERT_EQ(second.code, ExitCode::kOk) << second.err;
  EXPECT_THAT(second.out, HasSubstr("4. detail of head 0.5"));
  ASSERT_EQ(RunPleat({"motion", "undo", path_}).code, ExitCode::kOk);
  EXPECT_TRUE(Text() == edited);
  ASSERT_EQ(RunPleat({"motion", "undo", path_, "--count", "3"}).code, ExitCode::kOk);
  EXPECT_TRUE(Text() == before_);
  const Outcome none = RunPleat({"motion", "undo", path_});
  EXPECT_EQ(none.code, ExitCode::kBadInput);
  EXPECT_THAT(none.err, HasSubstr("has 0 edits"));
}

TEST_F(MotionEditVerbTest, AnotherFileIsWrittenByItsFlag) {
  const std::string other = files_.File("other.json");
  ASSERT_EQ(Edit({"--model", files_.model_path(), "--smooth", "all=.1", "-o", other}).code,
            ExitCode::kOk);
  EXPECT_TRUE(Text() == before_);
  EXPECT_EQ(Edit({"--model", files_.model_path(), "--smooth", "all=.1", "-o", other}).code,
            ExitCode::kUsage);
}

TEST_F(MotionEditVerbTest, MistakesLeaveTheFileAsItWas) {
  for (const auto& [flags, code, reason] :
       {std::tuple(std::vector<std::string>{"--mirror"}, ExitCode::kUsage, "--model"),
        std::tuple(std::vector<std::string>{"--model", files_.model_path()}, ExitCode::kUsage,
                   "give an edit"),
        std::tuple(std::vector<std::string>{"--model", files_.model_path(), "--mirror"},
                   ExitCode::kBadInput, "no left and right"),
        std::tuple(std::vector<std::string>{"--model", files_.model_path(), "--detail", "tail=1"},
                   ExitCode::kBadInput, "no joint 'tail'"),
        std::tuple(std::vector<std::string>{"--model", files_.model_path(), "--detail", "head=9"},
                   ExitCode::kUsage, "outside 0 to 2")}) {
    const Outcome outcome = Edit(flags);
    EXPECT_EQ(outcome.code, code) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(reason));
  }
  EXPECT_TRUE(Text() == before_);
}

TEST_F(MotionEditVerbTest, TheOldFormStillNeedsItsArguments) {
  const Outcome outcome = RunPleat({"motion", files_.model_path()});
  EXPECT_EQ(outcome.code, ExitCode::kUsage);
  EXPECT_THAT(outcome.err, HasSubstr("needs a model, a source and -o"));
}

}  // namespace
}  // namespace pleat
