#include "cli/io/edit_flags.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cli/exit_code.h"
#include "pleat/base/file.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(EditFlagsTest, EveryKindHasAFlagAndWords) {
  for (const EditForm& form : EditForms()) {
    EXPECT_TRUE(EditFlag(form.kind).starts_with("--"));
    EXPECT_FALSE(EditFlagHelp(form.kind).empty());
    EXPECT_EQ(EditFlagValue(form.kind).empty(), form.fields.empty()) << form.name;
  }
  EXPECT_EQ(EditFlag(EditKind::kOffsetRotation), "--offset-rotation");
  EXPECT_EQ(EditFlag(EditKind::kVertexDetail), "--detail-channel");
}

TEST(EditFlagsTest, TextsBecomeEdits) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const MotionEdit turn,
                             ParseEditFlag(EditKind::kOffsetRotation, "head+chest=0,20,-5.5"));
  EXPECT_THAT(turn.joints, ElementsAre("head", "chest"));
  EXPECT_THAT(turn.numbers, ElementsAre(ElementsAre(0, 20, -5.5)));
  PLEAT_ASSERT_OK_AND_ASSIGN(const MotionEdit limit, ParseEditFlag(EditKind::kLimit, "all=60"));
  EXPECT_THAT(limit.numbers, ElementsAre(ElementsAre(60), ElementsAre(180)));
  PLEAT_ASSERT_OK_AND_ASSIGN(const MotionEdit loop, ParseEditFlag(EditKind::kLoop, ".3,4"));
  EXPECT_THAT(loop.numbers, ElementsAre(ElementsAre(.3), ElementsAre(4)));
  PLEAT_ASSERT_OK_AND_ASSIGN(const MotionEdit warp, ParseEditFlag(EditKind::kTimeWarp, "0=0,1=2"));
  EXPECT_THAT(warp.numbers, ElementsAre(ElementsAre(0, 1), ElementsAre(0, 2)));
  PLEAT_ASSERT_OK_AND_ASSIGN(const MotionEdit mirror, ParseEditFlag(EditKind::kMirror, ""));
  EXPECT_EQ(DescribeEdit(mirror), "mirror");
  EXPECT_EQ(DescribeEdit(turn), "offset_rotation of head, chest 0,20,-5.5");
}

TEST(EditFlagsTest, FilesAreReadIntoTheEdit) {
  const TemporaryFolder folder;
  ASSERT_THAT(WriteFile(folder.File("a=b.json"), "{}"), IsOk());
  ASSERT_THAT(WriteFile(folder.File("paint.json"), "[0, 0.5, 2]"), IsOk());
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const MotionEdit blend,
      ParseEditFlag(EditKind::kBlend, folder.File("a=b.json") + "=.5:leftHand+head"));
  EXPECT_EQ(blend.other, "{}");
  EXPECT_THAT(blend.joints, ElementsAre("leftHand", "head"));
  EXPECT_THAT(blend.numbers, ElementsAre(ElementsAre(.5)));
  PLEAT_ASSERT_OK_AND_ASSIGN(const MotionEdit paint,
                             ParseEditFlag(EditKind::kVertexDetail, folder.File("paint.json")));
  EXPECT_THAT(paint.numbers, ElementsAre(ElementsAre(0, .5, 2)));
  EXPECT_EQ(ExitCodeOf(ParseEditFlag(EditKind::kConcatenate, folder.File("c.json")).status()),
            ExitCode::kNotFound);
}

TEST(EditFlagsTest, MistakesSayWhatTheTextShouldBe) {
  for (const auto& [kind, text, reason] :
       {std::tuple(EditKind::kOffsetRotation, "head", "is not JOINTS=X,Y,Z"),
        std::tuple(EditKind::kOffsetRotation, "head=1,2", "is not JOINTS=X,Y,Z"),
        std::tuple(EditKind::kOffsetRotation, "=1,2,3", "'joints' is empty"),
        std::tuple(EditKind::kDetail, "all=much", "is not JOINTS=STRENGTH"),
        std::tuple(EditKind::kDetail, "all=2.5", "outside 0 to 2"),
        std::tuple(EditKind::kDetail, "all=nan", "outside 0 to 2"),
        std::tuple(EditKind::kOffsetRoot, "1,2,3,4", "is not X,Y,Z"),
        std::tuple(EditKind::kTimeWarp, "1=2=3", "is not FROM=TO"),
        std::tuple(EditKind::kBlend, "a.json", "is not FILE=WEIGHT"),
        std::tuple(EditKind::kLoop, "", "is not BLEND")}) {
    const absl::Status status = ParseEditFlag(kind, text).status();
    EXPECT_EQ(ExitCodeOf(status), ExitCode::kUsage) << text;
    EXPECT_THAT(std::string(status.message()), HasSubstr(reason)) << text;
  }
}

}  // namespace
}  // namespace pleat
