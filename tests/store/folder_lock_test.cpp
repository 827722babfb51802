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
  std::optional<FileLock> lock(LockFolder(folder.path()).value());
  EXPECT_THAT(LockFolder(folder.path()).status(),
              HasStatus(absl::StatusCode::kFailedPrecondition, HasSubstr("in use")));
  const FileLock moved = *std::move(lock);
  lock.reset();  // it holds nothing any more
  EXPECT_FALSE(LockFolder(folder.path()).ok());
}

TEST(FolderLockTest, EndsWithItsHolder) {
  TemporaryFolder folder;
  for (int round = 0; round < 3; ++round) {
    EXPECT_TRUE(LockFolder(folder.path()).ok());
  }
  EXPECT_FALSE(LockFolder(folder.File("missing")).ok());
}

}  // namespace
}  // namespace pleat
