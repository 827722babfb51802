#include "pleat/mesh/input_note.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace pleat {
namespace {

using ::testing::IsEmpty;

const std::vector<std::string> kNames = {"f_1.obj", "f_2.obj", "f_3.obj", "f_4.obj", "f_5.obj",
                                         "f_6.obj", "f_7.obj", "f_8.obj", "f_9.obj"};

TEST(InputNoteTest, FramesAreNamedInRuns) {
  EXPECT_EQ(FrameLabel(kNames, 2), "frame 2 (f_3.obj)");
  EXPECT_EQ(FrameLabel({}, 2), "frame 2");
  EXPECT_EQ(FrameListLabel(kNames, {2}), "frame 2 (f_3.obj)");
  EXPECT_EQ(FrameListLabel(kNames, {2, 4, 5, 6}), "frames 2 (f_3.obj), 4 (f_5.obj) to 6");
  EXPECT_EQ(FrameListLabel({}, {1, 3, 5, 7, 9, 11}), "6 frames: 1, 3, 5, 7, ...");
}

TEST(InputNoteTest, EachKindIsSaidOnceInTheWordsOfItsFirstFrame) {
  FrameNotes notes;
  notes.Add(0, {{.kind = "all", .text = "first"}});
  for (int t = 1; t < 9; ++t) {
    std::vector<InputNote> of_frame = {{.kind = "all", .text = "other"}};
    if (t > 2) of_frame.push_back({.kind = "some", .text = "3 faces"});
    if (t == 5) of_frame.push_back({.kind = "one", .text = "odd"});
    notes.Add(t, of_frame);
  }
  const std::vector<InputNote> merged = notes.Merge(kNames, "in");
  ASSERT_EQ(merged.size(), 3u);
  EXPECT_EQ(merged[0].text, "frame 0 (f_1.obj): first; alike in all 9 frames");
  EXPECT_EQ(merged[1].text, "frame 3 (f_4.obj): 3 faces; alike in 6 of 9 frames");
  EXPECT_EQ(merged[1].frame, 3);
  EXPECT_EQ(merged[2].text, "frame 5 (f_6.obj): odd");
}

TEST(InputNoteTest, AFileAloneIsNamedInsteadOfItsFrame) {
  FrameNotes notes;
  notes.Add(0, {{.kind = "k", .text = "what"}});
  EXPECT_EQ(notes.Merge({"a.obj"}, "a.obj")[0].text, "a.obj: what");
  EXPECT_THAT(FrameNotes().Merge({"a.obj"}, "a.obj"), IsEmpty());
}

TEST(InputNoteTest, StrictRefusesWarningsAndDoubts) {
  EXPECT_FALSE(IsRefusedWhenStrict({.kind = "k"}));
  EXPECT_TRUE(IsRefusedWhenStrict({.severity = NoteSeverity::kWarning, .kind = "k"}));
  EXPECT_TRUE(IsRefusedWhenStrict({.kind = "k", .refused_when_strict = true}));
}

}  // namespace
}  // namespace pleat
