#include "upload_folders.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "pleat/base/file.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using testing::_;
using testing::EndsWith;

class UploadFoldersTest : public testing::Test {
 protected:
  UploadFolders Make(UploadFolderLimits limits = {}) {
    return UploadFolders(root(), limits, [this] { return now_; });
  }
  std::string root() const { return temporary_.path() + "/uploads"; }
  static absl::Status Put(UploadFolders& folders, const std::string& id, const std::string& path,
                          const std::string& bytes) {
    auto sink = folders.AddFile("me", id, path);
    return sink.ok() ? (*sink)->Append(bytes) : sink.status();
  }

  TemporaryFolder temporary_;
  double now_ = 0;
};

TEST_F(UploadFoldersTest, FilesLieInAFolderOfTheirOwner) {
  UploadFolders folders = Make();
  const std::string id = folders.Begin("me").value();
  ASSERT_THAT(Put(folders, id, "take/a.obj", "v 0 0 0"), IsOk());
  const UploadFolders::Folder folder = folders.Find("me", id).value();
  EXPECT_EQ(folder.bytes, 7u);
  EXPECT_EQ(ReadFile(folder.path + "/take/a.obj").value(), "v 0 0 0");
  EXPECT_THAT(folders.Find("you", id), HasStatus(absl::StatusCode::kNotFound, _));
  EXPECT_THAT(folders.AddFile("you", id, "b.obj"), HasStatus(absl::StatusCode::kNotFound, _));
  folders.Remove("you", id);
  EXPECT_TRUE(std::filesystem::exists(folder.path));
  folders.Remove("me", id);
  EXPECT_FALSE(std::filesystem::exists(folder.path));
}

TEST_F(UploadFoldersTest, NamesThatLeadElsewhereAndNamesThatAreTakenAreRefused) {
  UploadFolders folders = Make();
  const std::string id = folders.Begin("me").value();
  EXPECT_THAT(Put(folders, id, "../out", "x"), HasStatus(absl::StatusCode::kInvalidArgument, _));
  ASSERT_THAT(Put(folders, id, "a.obj", "x"), IsOk());
  EXPECT_THAT(Put(folders, id, "a.obj", "y"), HasStatus(absl::StatusCode::kInvalidArgument, _));
  EXPECT_THAT(Put(folders, id, "a.obj/b", "y"), HasStatus(absl::StatusCode::kInvalidArgument, _));
  EXPECT_EQ(ReadFile(folders.Find("me", id)->path + "/a.obj").value(), "x");
}

TEST_F(UploadFoldersTest, BytesFilesAndFoldersAreBounded) {
  UploadFolders folders =
      Make({.max_folders = 2, .max_files = 2, .max_bytes = 10, .idle_seconds = 5});
  const std::string id = folders.Begin("me").value();
  ASSERT_THAT(Put(folders, id, "a", "12345678"), IsOk());
  EXPECT_THAT(Put(folders, id, "b", "123"), HasStatus(absl::StatusCode::kResourceExhausted, _));
  EXPECT_THAT(Put(folders, id, "c", ""), HasStatus(absl::StatusCode::kResourceExhausted, _));
  const std::string other = folders.Begin("me").value();
  EXPECT_THAT(Put(folders, other, "a", "123"), HasStatus(absl::StatusCode::kResourceExhausted, _));
  EXPECT_THAT(folders.Begin("me"), HasStatus(absl::StatusCode::kResourceExhausted, _));
  now_ = 6;  // nobody has touched them
  const std::string third = folders.Begin("me").value();
  EXPECT_THAT(folders.Find("me", id), HasStatus(absl::StatusCode::kNotFound, _));
  EXPECT_THAT(Put(folders, third, "a", "1234567890"), IsOk());
}

TEST_F(UploadFoldersTest, NothingStaysBehind) {
  {
    UploadFolders folders = Make();
    ASSERT_THAT(Put(folders, folders.Begin("me").value(), "a", "x"), IsOk());
  }
  EXPECT_FALSE(std::filesystem::exists(root()));
}

TEST_F(UploadFoldersTest, ChoosesWhatIsRead) {
  UploadFolders folders = Make();
  const std::string frames = folders.Begin("me").value();
  EXPECT_THAT(ChooseInput(folders.Find("me", frames)->path),
              HasStatus(absl::StatusCode::kInvalidArgument, _));
  ASSERT_THAT(Put(folders, frames, "take/f1.obj", ""), IsOk());
  EXPECT_THAT(ChooseInput(folders.Find("me", frames)->path).value(), EndsWith("take/f1.obj"));
  ASSERT_THAT(Put(folders, frames, "take/f2.obj", ""), IsOk());
  EXPECT_THAT(ChooseInput(folders.Find("me", frames)->path).value(), EndsWith("/take"));
  ASSERT_THAT(Put(folders, frames, "take/x.PC2", ""), IsOk());
  EXPECT_THAT(ChooseInput(folders.Find("me", frames)->path).value(), EndsWith("x.PC2"));
}

}  // namespace
}  // namespace pleat
