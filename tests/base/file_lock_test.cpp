#include "pleat/base/file_lock.h"

#include <gtest/gtest.h>

#include <atomic>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "pleat/base/file.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

TEST(FileLockTest, HasOneHolderAtATime) {
  TemporaryFolder folder;
  const std::string path = folder.File("lock");
  std::optional<FileLock> lock = FileLock::Try(path, 0600).value();
  ASSERT_TRUE(lock);
  EXPECT_FALSE(FileLock::Try(path, 0600).value());
  {
    const FileLock moved = *std::move(lock);
    lock.reset();  // it holds nothing any more
    EXPECT_FALSE(FileLock::Try(path, 0600).value());
  }
  EXPECT_TRUE(FileLock::Try(path, 0600).value());
}

TEST(FileLockTest, WhoeverWaitsComesNext) {
  TemporaryFolder folder;
  const std::string path = folder.File("lock");
  std::atomic<int> num_inside = 0;
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&] {
      for (int i = 0; i < 50; ++i) {
        PLEAT_ASSERT_OK_AND_ASSIGN(const FileLock lock, FileLock::Wait(path, 0600));
        EXPECT_EQ(++num_inside, 1);
        --num_inside;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
}

TEST(FileLockTest, ANoteReplacesTheOneBefore) {
  TemporaryFolder folder;
  const std::string path = folder.File("lock");
  {
    PLEAT_ASSERT_OK_AND_ASSIGN(const FileLock lock, FileLock::Wait(path, 0644));
    lock.Note("process 123456");
    lock.Note("process 7");
  }
  EXPECT_EQ(ReadFile(path).value(), "process 7");
}

TEST(FileLockTest, AFileThatCannotBeMadeIsSaid) {
  TemporaryFolder folder;
  EXPECT_THAT(FileLock::Wait(folder.File("missing/lock"), 0600),
              HasStatus(absl::StatusCode::kNotFound, testing::HasSubstr("missing/lock")));
  EXPECT_THAT(FileLock::Try(folder.File("missing/lock"), 0600),
              HasStatus(absl::StatusCode::kNotFound, testing::HasSubstr("missing/lock")));
}

}  // namespace
}  // namespace pleat
