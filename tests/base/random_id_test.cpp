#include "pleat/base/random_id.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace pleat {
namespace {

TEST(RandomIdTest, HasItsLengthAndIsNeverTheSame) {
  EXPECT_THAT(RandomHexId(2), testing::MatchesRegex("[0-9a-f]{16}"));
  EXPECT_THAT(RandomHexId(4), testing::MatchesRegex("[0-9a-f]{32}"));
  EXPECT_NE(RandomHexId(4), RandomHexId(4));
}

}  // namespace
}  // namespace pleat
