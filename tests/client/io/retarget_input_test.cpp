#include "cli/io/retarget_input.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/tube_files.h"
#include "pleat/formats/bvh.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

TEST(RetargetInputTest, MotionsOfTheCharacterItselfAreNotForeign) {
  const TubeFiles files;
  const Skeleton& skeleton = files.model().skeleton();
  ASSERT_THAT(WriteBvh(files.File("own.bvh"), ClipFromPoses(skeleton, MakeMotion(skeleton, 3))),
              IsOk());
  RetargetSummary summary;
  for (const std::string& source :
       {files.motion_path(), files.sequence_path(), files.File("own.bvh")}) {
    const absl::StatusOr<std::optional<Motion>> motion =
        RetargetForeignClip({.source = source, .map = "", .fps = ""}, files.model(), &summary);
    ASSERT_TRUE(motion.ok()) << motion.status();
    EXPECT_FALSE(motion->has_value()) << source;
  }
}

TEST(RetargetInputTest, ABvhOfOtherJointsIsForeign) {
  const TubeFiles files;
  ASSERT_THAT(WriteFile(files.File("other.bvh"),
                        "HIERARCHY\nROOT A { OFFSET 0 0 0 CHANNELS 0 End Site { OFFSET 0 1 0 } }\n"
                        "MOTION\nFrames: 1\nFrame Time: .1\n"),
              IsOk());
  RetargetSummary summary;
  const auto motion = RetargetForeignClip({.source = files.File("other.bvh"), .map = "", .fps = ""},
                                          files.model(), &summary);
  EXPECT_FALSE(motion.ok());
  EXPECT_THAT(std::string(motion.status().message()), HasSubstr("other.bvh"));
}

}  // namespace
}  // namespace pleat
