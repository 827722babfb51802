#include "pleat/base/foreign_file.h"

#include "pleat/base/file.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

TEST(ForeignFileTest, WhatAFileReallyIsIsNamedWithAWayOut) {
  const std::pair<std::string, const char*> kCases[] = {
      {"version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 9\n", "git lfs pull"},
      {"/annex/objects/SHA256E-s9--0.obj\n", "git annex get"},
      {std::string("\xff\xfev\0 \0", 6), "UTF-16"},
      {std::string("\xfe\xff\0v\0 ", 6), "UTF-16"},
      {std::string("v\0 \0"
                   "0\0 \0"
                   "1\0",
                   10),
       "UTF-16"},
      {std::string("\0v\0 \0"
                   "0\0 ",
                   8),
       "UTF-16"},
      {"\x89HDF\r\n\x1a\n", "HDF5"},
      {"PK\x03\x04", "unpack"},
      {"<!DOCTYPE html>", "failed download"},
  };
  for (const auto& [bytes, words] : kCases) {
    EXPECT_THAT(
        RefuseForeignBytes(bytes, "a.obj"),
        HasStatus(absl::StatusCode::kInvalidArgument,
                  testing::AllOf(testing::StartsWith("a.obj: this is "), HasSubstr(words))));
  }
}

TEST(ForeignFileTest, MeshesAndShortFilesAreNotForeign) {
  for (const std::string& bytes :
       {std::string(), std::string("v"), std::string("v 0 0 0\n"), std::string("ply\n"),
        std::string("POINTCACHE2\0\1\0\0\0\2\0\0\0", 20), std::string(64, '\0'),
        std::string("\xef\xbb\xbfv 0 0 0\n")}) {
    EXPECT_THAT(DescribeForeignBytes(bytes), IsEmpty()) << bytes;
  }
}

TEST(ForeignFileTest, FilesAreNamedByTheirFirstBytes) {
  const TemporaryFolder folder;
  ASSERT_THAT(WriteFile(folder.File("a.abc"), "Ogawa" + std::string(1000, 'x')), IsOk());
  EXPECT_THAT(
      RefuseForeignFile(folder.File("a.abc")),
      HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("a.abc: this is an Alembic")));
  EXPECT_THAT(RefuseForeignFile(folder.File("none.abc")), IsOk());
}

}  // namespace
}  // namespace pleat
