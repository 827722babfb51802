#include "pleat/formats/frame_files.h"

#include "support/status_matchers.h"

namespace pleat {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr auto kInvalid = absl::StatusCode::kInvalidArgument;

absl::Status Sort(std::vector<std::string> paths, std::vector<std::string>* sorted = nullptr) {
  const absl::Status status = SortFrameFiles(&paths);
  if (sorted) *sorted = paths;
  return status;
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

TEST(FrameFilesTest, MissingNumberIsNamedWithItsNeighbors) {
  EXPECT_THAT(Sort({"f_001.obj", "f_002.obj", "f_004.obj", "f_005.obj"}),
              HasStatus(kInvalid, AllOf(HasSubstr("frame number 3 is missing"),
                                        HasSubstr("f_002.obj"), HasSubstr("f_004.obj"))));
  EXPECT_THAT(Sort({"f1.obj", "f3.obj"}), HasStatus(kInvalid, HasSubstr("number 2 is missing")));
}

TEST(FrameFilesTest, ConstantStepIsASeries) {
  EXPECT_THAT(Sort({"f0.obj", "f5.obj", "f10.obj", "f15.obj"}), IsOk());
  EXPECT_THAT(Sort({"f0.obj", "f5.obj", "f15.obj"}),
              HasStatus(kInvalid, HasSubstr("number 10 is")));
}

TEST(FrameFilesTest, DoubledNumberIsNamed) {
  EXPECT_THAT(Sort({"f1.obj", "f2.obj", "f02.obj", "f3.obj"}),
              HasStatus(kInvalid, AllOf(HasSubstr("number 2 is there twice"), HasSubstr("'f2.obj'"),
                                        HasSubstr("'f02.obj'"))));
}

TEST(FrameFilesTest, StrangerInASeriesIsNamed) {
  EXPECT_THAT(Sort({"f1.obj", "f2.obj", "f3.obj", "template.obj"}),
              HasStatus(kInvalid, HasSubstr("'template.obj' does not belong")));
}

TEST(FrameFilesTest, OnlyTheNumberThatCountsIsChecked) {
  EXPECT_THAT(Sort({"take2/walk_1_v3.obj", "take2/walk_2_v3.obj", "take2/walk_3_v3.obj"}), IsOk());
  EXPECT_THAT(Sort({"walk_1_v3.obj", "walk_2_v3.obj", "walk_4_v3.obj"}),
              HasStatus(kInvalid, HasSubstr("number 3 is missing")));
  EXPECT_THAT(Sort({"t1/mesh.obj", "t2/mesh.obj", "t4/mesh.obj"}),
              HasStatus(kInvalid, HasSubstr("number 3 is missing")));
}

TEST(FrameFilesTest, NamesWithoutASeriesAreTakenAsTheySort) {
  std::vector<std::string> sorted;
  EXPECT_THAT(Sort({"sit.obj", "run.obj", "jump.obj"}, &sorted), IsOk());
  EXPECT_THAT(sorted, ElementsAre("jump.obj", "run.obj", "sit.obj"));
  EXPECT_THAT(Sort({"only_7.obj"}), IsOk());
}

}  // namespace
}  // namespace pleat
