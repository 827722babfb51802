#include "pleat/store/open_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>

#include "pleat/base/file.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

TEST(OpenFileTest, RangesAreExactUpToTheLargestNumbers) {
  TemporaryFolder folder;
  const std::string content = "0123456789";
  ASSERT_THAT(WriteFile(folder.File("f"), content), IsOk());
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto file, OpenFile::Open(folder.File("f"), "id"));
  EXPECT_EQ(file->size_bytes(), 10u);
  const uint64_t most = std::numeric_limits<uint64_t>::max();
  for (uint64_t offset = 0; offset <= 10; ++offset) {
    for (const uint64_t count : {uint64_t{0}, uint64_t{1}, uint64_t{9}, most - 3, most}) {
      EXPECT_EQ(file->Read(offset, count).value(), content.substr(offset, count));
    }
  }
  for (const uint64_t offset : {uint64_t{11}, uint64_t{1} << 63, most}) {
    EXPECT_THAT(file->Read(offset, most), HasStatus(absl::StatusCode::kOutOfRange, testing::_));
  }
}

TEST(OpenFileTest, ItIsReadToItsEndWhenItsNameIsGone) {
  TemporaryFolder folder;
  ASSERT_THAT(WriteFile(folder.File("f"), "content"), IsOk());
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto file, OpenFile::Open(folder.File("f"), "id"));
  std::filesystem::remove(folder.File("f"));
  EXPECT_EQ(file->Read(0, 100).value(), "content");
}

TEST(OpenFileTest, ErrorsNameTheIdAndNoPath) {
  TemporaryFolder folder;
  const auto names_the_id = testing::AllOf(HasSubstr("'id'"), Not(HasSubstr(folder.path())));
  EXPECT_THAT(OpenFile::Open(folder.File("none"), "id"),
              HasStatus(absl::StatusCode::kNotFound, names_the_id));
  std::filesystem::create_directory(folder.File("folder"));
  EXPECT_FALSE(OpenFile::Open(folder.File("folder"), "id").ok());
  // A file that became shorter behind the back of the store.
  ASSERT_THAT(WriteFile(folder.File("f"), "content"), IsOk());
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto file, OpenFile::Open(folder.File("f"), "id"));
  std::filesystem::resize_file(folder.File("f"), 3);
  EXPECT_THAT(file->Read(0, 7), HasStatus(absl::StatusCode::kUnavailable, names_the_id));
}

}  // namespace
}  // namespace pleat
