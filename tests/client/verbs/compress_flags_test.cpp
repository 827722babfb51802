#include "cli/verbs/compress_flags.h"

#include <gtest/gtest.h>

#include "cli/exit_code.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

TEST(CompressFlagsTest, OneGoalIsChosen) {
  EXPECT_EQ(ResolveCompressFlags({.max_error_mm = 2})->max_error_mm, 2);
  EXPECT_EQ(ResolveCompressFlags({.kg_percent = .5})->goal, CompressionGoal::kKg);
  const auto grid = ResolveCompressFlags({.grid_bits = 10, .any_face_order = true}).value();
  EXPECT_EQ(grid.goal, CompressionGoal::kGrid);
  EXPECT_EQ(grid.grid_bits, 10);
  EXPECT_FALSE(grid.keep_face_order);
}

TEST(CompressFlagsTest, NoneAndTwoAreUsageErrors) {
  EXPECT_FALSE(CompressFlags{}.any_goal());
  EXPECT_TRUE(IsUsageError(ResolveCompressFlags({}).status()));
  EXPECT_TRUE(IsUsageError(ResolveCompressFlags({.max_error_mm = 1, .kg_percent = 1}).status()));
}

}  // namespace
}  // namespace pleat
