#include "pleat/local/stored_files.h"

#include <gtest/gtest.h>

#include "data_folder.h"
#include "pleat/base/sha256.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::_;
using ::testing::HasSubstr;

class StoredFilesTest : public testing::Test {
 protected:
  StoredFilesTest() {
    folder_.Open({.max_upload_bytes = 1000});
    EXPECT_THAT(files().Add(EntryKind::kModel, {id_, "a record"}, content_), IsOk());
  }
  StoredFiles& files() { return folder_.files(); }

  DataFolder folder_;
  const std::string content_ = "0123456789";
  const std::string id_ = ToHex(ComputeSha256(content_));
  const std::string other_id_ = std::string(64, 'a');
};

TEST_F(StoredFilesTest, PiecesOfAFileEndWithIt) {
  for (const uint64_t offset : {0, 3, 10}) {
    PLEAT_ASSERT_OK_AND_ASSIGN(const auto download,
                               files().OpenDownload(EntryKind::kModel, id_, offset));
    EXPECT_EQ(download->size_bytes(), 10u);
    EXPECT_EQ(download->Next().value(), content_.substr(offset));
    EXPECT_EQ(download->Next().value(), "");
  }
  EXPECT_THAT(files().OpenDownload(EntryKind::kModel, id_, 11),
              HasStatus(absl::StatusCode::kOutOfRange, HasSubstr("11")));
}

// A file is there for the kind it was stored as: an id of another kind does not open it.
TEST_F(StoredFilesTest, AFileIsOfItsKindOnly) {
  EXPECT_THAT(files().OpenDownload(EntryKind::kSequence, id_, 0),
              HasStatus(absl::StatusCode::kNotFound, _));
  EXPECT_THAT(files().Delete(EntryKind::kSequence, id_), HasStatus(absl::StatusCode::kNotFound, _));
  EXPECT_THAT(files().OpenDownload(EntryKind::kModel, other_id_, 0),
              HasStatus(absl::StatusCode::kNotFound, _));
  EXPECT_EQ(files().Download(EntryKind::kModel, id_, 10, {}).value(), content_);
}

TEST_F(StoredFilesTest, ADownloadReportsAndCanBeCancelled) {
  double fraction = 0;
  const Progress progress([&](const ProgressUpdate& update) { fraction = update.fraction; }, {});
  EXPECT_EQ(files().Download(EntryKind::kModel, id_, 10, progress).value(), content_);
  EXPECT_EQ(fraction, 1);
  EXPECT_THAT(files().Download(EntryKind::kModel, id_, 10, Progress({}, [] { return true; })),
              HasStatus(absl::StatusCode::kCancelled, _));
}

TEST_F(StoredFilesTest, AFileThatIsShorterThanItsRowSaysIsNoticed) {
  EXPECT_THAT(files().Download(EntryKind::kModel, id_, 11, {}),
              HasStatus(absl::StatusCode::kDataLoss, HasSubstr("cut off")));
  std::filesystem::remove(folder_.PathOf(id_));
  EXPECT_FALSE(files().Download(EntryKind::kModel, id_, 10, {}).ok());
}

TEST_F(StoredFilesTest, NoByteOfADamagedFileIsGivenOut) {
  std::filesystem::resize_file(folder_.PathOf(id_), 7);
  EXPECT_THAT(files().OpenDownload(EntryKind::kModel, id_, 0),
              HasStatus(absl::StatusCode::kDataLoss, HasSubstr(id_)));
  EXPECT_FALSE(std::filesystem::exists(folder_.PathOf(id_)));  // it is in quarantine
  EXPECT_EQ(folder_.problems().size(), 1u);
  EXPECT_THAT(files().Add(EntryKind::kModel, {id_, "a record"}, content_), IsOk());
  EXPECT_TRUE(files().IsIntact(id_));
  EXPECT_EQ(files().Read(id_).value(), content_);
}

TEST_F(StoredFilesTest, ADownloadThatHasBegunOutlivesItsFile) {
  const std::string content(3 * kDownloadPieceBytes + 1, 'x'), id = ToHex(ComputeSha256(content));
  ASSERT_THAT(files().Add(EntryKind::kModel, {id, ""}, content), IsOk());
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto download, files().OpenDownload(EntryKind::kModel, id, 0));
  std::string bytes = download->Next().value();
  EXPECT_EQ(bytes.size(), static_cast<size_t>(kDownloadPieceBytes));
  ASSERT_THAT(files().Delete(EntryKind::kModel, id), IsOk());
  EXPECT_FALSE(std::filesystem::exists(folder_.PathOf(id)));
  for (int i = 0; i < 3; ++i) bytes += download->Next().value();
  EXPECT_TRUE(bytes == content);
}

TEST_F(StoredFilesTest, UploadsAreCheckedBeforeTheFirstByte) {
  EXPECT_THAT(files().BeginUpload(other_id_, 0, 0),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("0 bytes")));
  EXPECT_THAT(files().BeginUpload(other_id_, 1001, 0),
              HasStatus(absl::StatusCode::kResourceExhausted,
                        "the upload has 1001 bytes, the limit (--max-upload-bytes) is 1000"));
  EXPECT_THAT(files().BeginUpload(other_id_, ~uint64_t{0}, 0),
              HasStatus(absl::StatusCode::kResourceExhausted, _));
  EXPECT_THAT(files().BeginUpload(other_id_, 10, 11),
              HasStatus(absl::StatusCode::kOutOfRange, HasSubstr("offset 11")));
  EXPECT_THAT(files().BeginUpload(other_id_, 10, 5),  // nothing has arrived
              HasStatus(absl::StatusCode::kOutOfRange, HasSubstr("go on")));
  for (const std::string& wrong : {std::string("../../etc/passwd"), std::string(64, 'A'),
                                   std::string(63, 'a'), std::string()}) {
    EXPECT_THAT(files().BeginUpload(wrong, 10, 0),
                HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("hexadecimal")));
  }
}

TEST_F(StoredFilesTest, AnUploadHasOneWriter) {
  auto upload = files().BeginUpload(other_id_, 10, 0);
  ASSERT_THAT(upload, IsOk());
  EXPECT_THAT(files().BeginUpload(other_id_, 10, 0), HasStatus(absl::StatusCode::kAborted, _));
  EXPECT_THAT(upload->upload->Append("01234567890"), HasStatus(absl::StatusCode::kOutOfRange, _));
  upload->upload.reset();
  EXPECT_THAT(files().BeginUpload(other_id_, 10, 0), IsOk());
}

TEST_F(StoredFilesTest, WhatTheDiskCannotTakeIsRefused) {
  folder_.Open({.max_upload_bytes = int64_t{1} << 62});
  EXPECT_THAT(files().BeginUpload(other_id_, uint64_t{1} << 60, 0),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("no room")));
  const std::string bytes = "something else", id = ToHex(ComputeSha256(bytes));
  folder_.Block(id);
  const absl::Status status = files().Add(EntryKind::kModel, {id, ""}, bytes);
  EXPECT_THAT(status.message(), HasSubstr("cannot create"));
  EXPECT_THAT(files().OpenDownload(EntryKind::kModel, id, 0),
              HasStatus(absl::StatusCode::kNotFound, _));
  // What is there can still be read, and be added again.
  EXPECT_EQ(files().Download(EntryKind::kModel, id_, 10, {}).value(), content_);
  EXPECT_THAT(files().Add(EntryKind::kModel, {id_, "another record"}, content_), IsOk());
  folder_.Unblock(id);
  EXPECT_THAT(files().Add(EntryKind::kModel, {id, ""}, bytes), IsOk());
}

}  // namespace
}  // namespace pleat
