#include "pleat/math/clip_starts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(ClipStartsTest, TheWrongEntryIsNamed) {
  EXPECT_THAT(CheckClipStarts({0}, 1), IsOk());
  EXPECT_THAT(CheckClipStarts({0, 3, 4}, 5), IsOk());
  EXPECT_THAT(CheckClipStarts({}, 5),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("empty")));
  EXPECT_THAT(CheckClipStarts({0}, 0),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("entry 0")));
  EXPECT_THAT(CheckClipStarts({2, 3}, 5),
              HasStatus(absl::StatusCode::kInvalidArgument,
                        AllOf(HasSubstr("entry 0"), HasSubstr("is 2"))));
  EXPECT_THAT(CheckClipStarts({0, 3, 3}, 5),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("entry 2")));
  EXPECT_THAT(CheckClipStarts({0, 5}, 5),
              HasStatus(absl::StatusCode::kInvalidArgument,
                        AllOf(HasSubstr("entry 1"), HasSubstr("the 5 frames"))));
}

TEST(ClipStartsTest, EveryFrameIsInOneClip) {
  for (int t = 0; t < 9; ++t) {
    const ClipRange range = ClipOfFrame({0, 2, 3}, 9, t);
    EXPECT_LE(range.begin, t);
    EXPECT_LT(t, range.end);
    EXPECT_EQ(range.clip, t < 2 ? 0 : t < 3 ? 1 : 2);
  }
}

TEST(ClipStartsTest, TheRangesOfAllClipsFollowEachOther) {
  int num_frames = 0, num_clips = 0;
  for (const ClipRange& range : ClipRanges({0, 2, 3}, 9)) {
    EXPECT_EQ(range.clip, num_clips++);
    EXPECT_EQ(range.begin, num_frames);
    EXPECT_EQ(range.end, range.clip == 0 ? 2 : range.clip == 1 ? 3 : 9);
    num_frames = range.end;
  }
  EXPECT_EQ(num_clips, 3);
}

}  // namespace
}  // namespace pleat
