#include "pleat/formats/frame_files.h"

#include "support/status_matchers.h"

namespace pleat {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

absl::Status Sort(const std::vector<std::string>& paths,
                  std::vector<std::string>* sorted = nullptr) {
  const absl::StatusOr<FrameFiles> files = SortFrameFiles(paths);
  if (sorted && files.ok()) *sorted = files->paths;
  return files.status();
}

// "severity kind: text" of every note, and the names in their order.
struct Sorted {
  std::vector<std::string> paths;
  std::string notes;
};
Sorted SortedWithNotes(const std::vector<std::string>& paths) {
  const absl::StatusOr<FrameFiles> files = SortFrameFiles(paths);
  EXPECT_THAT(files, IsOk());
  if (!files.ok()) return {};
  Sorted sorted{files->paths, ""};
  for (const InputNote& note : files->notes) {
    EXPECT_TRUE(IsRefusedWhenStrict(note)) << note.text;
    sorted.notes += std::string(SeverityName(note.severity)) + " " + note.kind + ": " + note.text;
  }
  return sorted;
}

TEST(FrameFilesTest, NaturalOrder) {
  EXPECT_TRUE(NaturalLess("frame2", "frame10"));
  EXPECT_FALSE(NaturalLess("frame10", "frame2"));
  EXPECT_TRUE(NaturalLess("frame9", "frame010"));
  EXPECT_TRUE(NaturalLess("a1b2", "a1b10"));
  EXPECT_TRUE(NaturalLess("frame", "frame1"));
  EXPECT_TRUE(NaturalLess("f99999999999999999999998", "f99999999999999999999999"));
  EXPECT_FALSE(NaturalLess("same1", "same1"));
  EXPECT_NE(NaturalLess("f01", "f1"), NaturalLess("f1", "f01"));  // a strict order
}

TEST(FrameFilesTest, SortsWithoutZeroPadding) {
  std::vector<std::string> sorted;
  EXPECT_THAT(Sort({"d/f10.obj", "d/f9.obj", "d/f11.obj", "d/f8.obj"}, &sorted), IsOk());
  EXPECT_THAT(sorted, ElementsAre("d/f8.obj", "d/f9.obj", "d/f10.obj", "d/f11.obj"));
}

TEST(FrameFilesTest, MissingNumbersAreAWarningWithTheirNeighbors) {
  const Sorted gaps = SortedWithNotes({"f_8.obj", "f_1.obj", "f_2.obj", "f_3.obj", "f_5.obj"});
  EXPECT_THAT(gaps.paths, ElementsAre("f_1.obj", "f_2.obj", "f_3.obj", "f_5.obj", "f_8.obj"));
  EXPECT_THAT(gaps.notes, AllOf(HasSubstr("warning numbers_missing"),
                                HasSubstr("frame numbers 4, 6 to 7 are missing"),
                                HasSubstr("the first between 'f_3.obj' and 'f_5.obj'")));
  EXPECT_THAT(SortedWithNotes({"f1.obj", "f3.obj"}).notes,
              HasSubstr("frame number 2 is missing between 'f1.obj' and 'f3.obj'"));
}

TEST(FrameFilesTest, ConstantStepIsASeries) {
  EXPECT_EQ(SortedWithNotes({"f0.obj", "f5.obj", "f10.obj", "f15.obj"}).notes, "");
  EXPECT_THAT(SortedWithNotes({"f0.obj", "f5.obj", "f15.obj"}).notes, HasSubstr("number 10 is"));
  EXPECT_THAT(SortedWithNotes({"f0.obj", "f5.obj", "f12.obj"}).notes,
              HasSubstr("no frame numbers"));
}

TEST(FrameFilesTest, NegativeNumbersComeFirst) {
  const Sorted with_underscore =
      SortedWithNotes({"f_-1.obj", "f_-2.obj", "f_0.obj", "f_1.obj", "f_2.obj"});
  EXPECT_THAT(with_underscore.paths,
              ElementsAre("f_-2.obj", "f_-1.obj", "f_0.obj", "f_1.obj", "f_2.obj"));
  EXPECT_THAT(with_underscore.notes, HasSubstr("note negative_numbers"));
  EXPECT_THAT(SortedWithNotes({"f-001.obj", "f000.obj", "f-010.obj", "f001.obj"}).paths,
              ElementsAre("f-010.obj", "f-001.obj", "f000.obj", "f001.obj"));
  // A hyphen that only separates is no sign.
  const Sorted separated =
      SortedWithNotes({"walk-2.obj", "walk-10.obj", "walk-1.obj", "walk-3.obj", "walk-4.obj",
                       "walk-5.obj", "walk-6.obj", "walk-7.obj", "walk-8.obj", "walk-9.obj"});
  EXPECT_EQ(separated.paths[0], "walk-1.obj");
  EXPECT_EQ(separated.notes, "");
  EXPECT_EQ(SortedWithNotes({"2024-01-02_1.obj", "2024-01-02_2.obj"}).notes, "");
}

TEST(FrameFilesTest, TimeStampsAreTakenInTheirOrder) {
  const Sorted even = SortedWithNotes({"m_1718181818190123.obj", "m_1718181818123456.obj",
                                       "m_1718181818223501.obj", "m_1718181818156790.obj"});
  EXPECT_EQ(even.paths[1], "m_1718181818156790.obj");
  EXPECT_THAT(even.notes, AllOf(HasSubstr("note time_stamps"), testing::Not(HasSubstr("warning"))));
  const Sorted dropped = SortedWithNotes({"m_1718181818123456.obj", "m_1718181818156790.obj",
                                          "m_1718181818190123.obj", "m_1718181818256790.obj"});
  EXPECT_THAT(dropped.notes, AllOf(HasSubstr("warning time_stamps_missing"),
                                   HasSubstr("between 'm_1718181818190123.obj'")));
}

TEST(FrameFilesTest, DoubledNumberIsNamed) {
  EXPECT_THAT(Sort({"f1.obj", "f2.obj", "f02.obj", "f3.obj"}),
              HasStatus(kInvalid, AllOf(HasSubstr("number 2 is there twice"), HasSubstr("'f2.obj'"),
                                        HasSubstr("'f02.obj'"))));
}

TEST(FrameFilesTest, AReferenceBesideASeriesIsLeftOutAndSaid) {
  const Sorted sorted = SortedWithNotes({"f1.obj", "f2.obj", "f3.obj", "template.obj"});
  EXPECT_THAT(sorted.paths, ElementsAre("f1.obj", "f2.obj", "f3.obj"));
  EXPECT_THAT(sorted.notes, HasSubstr("note files_left_out: 'template.obj' is left out"));
  EXPECT_THAT(SortedWithNotes({"f1.obj", "f2.obj", "f3.obj", "ref.ply", "T-pose.obj"}).notes,
              HasSubstr("and 1 other file are left out"));
  std::vector<std::string> many = {"ref2.obj"};
  for (int t = 0; t < 30; ++t) many.push_back("f" + std::to_string(t) + ".obj");
  EXPECT_THAT(SortedWithNotes(many).notes, HasSubstr("'ref2.obj' is left out"));
}

TEST(FrameFilesTest, FilesThatMayBeMeantAreRefused) {
  EXPECT_THAT(Sort({"f1.obj", "f2.obj", "f3.obj", "g1.obj"}),
              HasStatus(kInvalid, HasSubstr("'g1.obj' does not belong")));
  EXPECT_THAT(Sort({"f1.obj", "f2.obj", "f3.obj", "f4.obj", "g1.obj", "g2.obj"}),
              HasStatus(kInvalid, HasSubstr("'g1.obj' does not belong")));
  EXPECT_THAT(Sort({"f1.obj", "f2.obj", "a.obj", "b.obj"}),
              HasStatus(kInvalid, HasSubstr("does not belong")));
}

TEST(FrameFilesTest, OnlyTheNumberThatCountsIsChecked) {
  EXPECT_THAT(Sort({"take2/walk_1_v3.obj", "take2/walk_2_v3.obj", "take2/walk_3_v3.obj"}), IsOk());
  for (const auto& names :
       std::vector<std::vector<std::string>>{{"walk_1_v3.obj", "walk_2_v3.obj", "walk_4_v3.obj"},
                                             {"t1/mesh.obj", "t2/mesh.obj", "t4/mesh.obj"}}) {
    EXPECT_THAT(SortedWithNotes(names).notes, HasSubstr("number 3 is missing"));
  }
}

TEST(FrameFilesTest, ANumberSignInANameIsNoNumber) {
  EXPECT_THAT(Sort({"#f#.obj", "#f-22.obj"}), IsOk());
  EXPECT_THAT(SortedWithNotes({"#1.obj", "##.obj", "#2.obj", "#3.obj"}).notes,
              HasSubstr("'##.obj' is left out"));
}

TEST(FrameFilesTest, NamesWithoutASeriesAreTakenAsTheySort) {
  std::vector<std::string> sorted;
  EXPECT_THAT(Sort({"sit.obj", "run.obj", "jump.obj"}, &sorted), IsOk());
  EXPECT_THAT(sorted, ElementsAre("jump.obj", "run.obj", "sit.obj"));
  EXPECT_THAT(Sort({"only_7.obj"}), IsOk());
}

// No file system has such names, but whoever calls the library may.
TEST(SortFrameFilesTest, ZeroBytesAreNoNumbers) {
  const std::string strange("a_-1.o-\0\0b", 10), other("a_1.o\0\0b", 8);
  const auto files = SortFrameFiles({strange, other});
  if (!files.ok()) return;
  EXPECT_EQ(files->paths.size(), 2u);
}

}  // namespace
}  // namespace pleat
