#include "pleat/base/file.h"

#include <filesystem>
#include <vector>

#include "pleat/base/file_parts.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using testing::HasSubstr;

TEST(FileTest, WritesAndReadsBytesIncludingZeros) {
  const TemporaryFolder folder;
  const std::string bytes("a\0b\n\xff", 5);
  ASSERT_THAT(WriteFile(folder.File("new/folders/file.bin"), bytes), IsOk());
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::string read, ReadFile(folder.File("new/folders/file.bin")));
  EXPECT_EQ(read, bytes);
}

TEST(FileTest, OverwritesAndLeavesNothingElseBehind) {
  const TemporaryFolder folder;
  ASSERT_THAT(WriteFile(folder.File("f"), "long old content"), IsOk());
  ASSERT_THAT(WriteFile(folder.File("f"), "new"), IsOk());
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::string read, ReadFile(folder.File("f")));
  EXPECT_EQ(read, "new");
  int num_files = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder.path())) {
    ++num_files;
  }
  EXPECT_EQ(num_files, 1);
}

TEST(FileTest, PartsAreWrittenOneAfterTheOther) {
  const TemporaryFolder folder;
  const std::vector<std::string_view> parts = {"ab", "", "c"};
  ASSERT_THAT(WriteFileParts(folder.File("f"), parts), IsOk());
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::string read, ReadFile(folder.File("f")));
  EXPECT_EQ(read, "abc");
  EXPECT_FALSE(WriteFileParts("/dev/null/f", parts).ok());
}

TEST(FileTest, ALinkThatLeadsInACircleIsBadInput) {
  const TemporaryFolder folder;
  std::filesystem::create_symlink("loop", folder.File("loop"));
  EXPECT_THAT(ReadFile(folder.File("loop")),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("cannot open")));
}

TEST(FileTest, MissingFileFolderAndTooLargeFileAreNamed) {
  const TemporaryFolder folder;
  EXPECT_THAT(ReadFile(folder.File("absent")),
              HasStatus(absl::StatusCode::kNotFound, HasSubstr("absent")));
  EXPECT_THAT(ReadFile(folder.path()),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("regular file")));
  ASSERT_THAT(WriteFile(folder.File("big"), "12345"), IsOk());
  EXPECT_THAT(ReadFile(folder.File("big"), 4),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("limit is 4")));
  EXPECT_THAT(ReadFile(folder.File("big"), 5), IsOk());
}

TEST(FileTest, WriteUnderAFileFails) {
  const TemporaryFolder folder;
  ASSERT_THAT(WriteFile(folder.File("plain"), "x"), IsOk());
  EXPECT_FALSE(WriteFile(folder.File("plain/child"), "y").ok());
}

}  // namespace
}  // namespace pleat
