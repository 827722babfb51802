#include "cli/show/sheet.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cli/exit_code.h"
#include "client/test_sequence.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST(Sheet, SpacesFramesFromFirstToLast) {
  EXPECT_THAT(SpacedFrames(101, 5), ElementsAre(0, 25, 50, 75, 100));
  EXPECT_THAT(SpacedFrames(3, 8), ElementsAre(0, 1, 2));
  EXPECT_THAT(SpacedFrames(1, 1), ElementsAre(0));
  EXPECT_THAT(SpacedFrames(10, 1), ElementsAre(0));
}

TEST(Sheet, ParsesFrameLists) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::vector<int> frames, ParseFrameList("0,12,5"));
  EXPECT_THAT(frames, ElementsAre(0, 12, 5));
  for (const char* text : {"", "a", "1,,2", "-1", "1;2", "99999999999"}) {
    EXPECT_TRUE(IsUsageError(ParseFrameList(text).status())) << text;
  }
}

TEST(Sheet, DrawsEveryRow) {
  SheetOptions options;
  options.tile_width = options.tile_height = 48;
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const std::string png,
      RenderSheet({{"one", MovingTetrahedron(9)}, {"two", MovingTetrahedron(4)}}, options));
  EXPECT_THAT(png, StartsWith("\x89PNG"));
}

TEST(Sheet, NamesTheRowThatLacksAFrame) {
  SheetOptions options;
  options.frames = {0, 5};
  EXPECT_THAT(
      RenderSheet({{"long", MovingTetrahedron(9)}, {"short", MovingTetrahedron(4)}}, options),
      HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("'short' has no frame 5")));
}

}  // namespace
}  // namespace pleat
