#include "pleat/base/content_id.h"

#include <gtest/gtest.h>

#include <string>

#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

TEST(ContentId, Is64LowerCaseHexadecimalDigits) {
  const std::string good = "0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef";
  EXPECT_TRUE(IsContentId(good));
  EXPECT_THAT(CheckContentId(good, "id"), IsOk());
}

TEST(ContentId, EverythingElseIsRefusedByName) {
  std::string upper(64, 'a'), path(64, 'a'), zero(64, 'a');
  upper[5] = 'A';
  path[0] = '/';
  zero[63] = '\0';
  for (const std::string& bad : {std::string(), std::string(63, 'a'), std::string(65, 'a'),
                                 std::string(64, 'g'), upper, path, zero}) {
    EXPECT_FALSE(IsContentId(bad)) << bad;
    EXPECT_THAT(CheckContentId(bad, "sequence_id"),
                HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("sequence_id must be 64")));
  }
}

}  // namespace
}  // namespace pleat
