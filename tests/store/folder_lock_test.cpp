#include "folder_lock.h"

#include <gtest/gtest.h>

#include <optional>
#include <utility>

#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

TEST(FolderLockTest, HasOneHolderAtATime) {
  TemporaryFolder folder;
  std::optional<FolderLock> lock(FolderLock::Take(folder.path()).value());
  EXPECT_THAT(FolderLock::Take(folder.path()).status(),
              HasStatus(absl::StatusCode::kFailedPrecondition, HasSubstr("in use")));
  const FolderLock moved = *std::move(lock);
  lock.reset();  // it holds nothing any more
  EXPECT_FALSE(FolderLock::Take(folder.path()).ok());
}

TEST(FolderLockTest, EndsWithItsHolder) {
  TemporaryFolder folder;
  for (int round = 0; round < 3; ++round) {
    EXPECT_TRUE(FolderLock::Take(folder.path()).ok());
  }
  EXPECT_FALSE(FolderLock::Take(folder.File("missing")).ok());
}

}  // namespace
}  // namespace pleat
