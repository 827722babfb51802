#include "pleat/local/local_sequences.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include "data_folder.h"
#include "pleat/base/file.h"
#include "pleat/formats/sequence_file.h"
#include "support/fake_training.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::_;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class LocalSequencesTest : public testing::Test {
 protected:
  LocalSequencesTest() { folder_.Open(); }
  LocalSequences& sequences() { return folder_.sequences(); }
  // Uploads in pieces; the status of the end.
  absl::Status UploadBytes(const std::string& id, const std::string& bytes) {
    auto upload = sequences().BeginUpload(id, bytes.size(), 0);
    if (!upload.ok()) return upload.status();
    for (size_t at = 0; at < bytes.size(); at += 1000) {
      if (absl::Status status = (*upload)->Append(bytes.substr(at, 1000)); !status.ok()) {
        return status;
      }
    }
    return (*upload)->Finish().status();
  }

  DataFolder folder_;
  const MeshSequence tube_ = MakeSwayingTube(4);
  const std::string bytes_ = EncodeSequence(tube_);
  const std::string id_ = SequenceId(bytes_);
};

TEST_F(LocalSequencesTest, WhatIsLoadedIsWhatCameIn) {
  ASSERT_THAT(UploadBytes(id_, bytes_), IsOk());
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence loaded, sequences().Load(id_));
  EXPECT_TRUE(EncodeSequence(loaded) == bytes_);
  EXPECT_EQ(sequences().Upload(tube_, {})->id, id_);
  EXPECT_EQ(sequences().List()->size(), 1u);
}

TEST_F(LocalSequencesTest, AnUploadThatIsNotWholeIsNoSequence) {
  {
    PLEAT_ASSERT_OK_AND_ASSIGN(const auto upload, sequences().BeginUpload(id_, bytes_.size(), 0));
    ASSERT_THAT(upload->Append(bytes_.substr(0, 500)), IsOk());
    EXPECT_EQ(upload->received_bytes(), 500u);
    EXPECT_THAT(upload->Finish(), HasStatus(absl::StatusCode::kFailedPrecondition, _));
  }
  EXPECT_EQ(sequences().QueryUpload(id_)->received_bytes, 500u);  // it may go on
  EXPECT_THAT(sequences().BeginUpload(id_, bytes_.size(), 499),
              HasStatus(absl::StatusCode::kOutOfRange, _));
  std::string wrong = bytes_;
  wrong[700] ^= 1;
  EXPECT_THAT(UploadBytes(id_, wrong), HasStatus(absl::StatusCode::kDataLoss, HasSubstr("SHA")));
  EXPECT_THAT(sequences().Get(id_), HasStatus(absl::StatusCode::kNotFound, _));
  EXPECT_THAT(UploadBytes(id_, bytes_), IsOk());  // starts again
}

TEST_F(LocalSequencesTest, ASequenceIsCreatedWhenItFirstComes) {
  const absl::Time first = folder_.now();
  EXPECT_EQ(sequences().Upload(tube_, {})->life.created, first);
  folder_.Pass(absl::Hours(1));
  EXPECT_EQ(sequences().Upload(tube_, {})->life.created, first);
  ASSERT_THAT(UploadBytes(id_, bytes_), IsOk());
  EXPECT_EQ(sequences().Get(id_)->life.created, first);
  EXPECT_EQ(sequences().List()->at(0).life.created, first);
  ASSERT_THAT(sequences().Delete(id_), IsOk());
  EXPECT_EQ(sequences().Upload(tube_, {})->life.created, folder_.now());
}

TEST_F(LocalSequencesTest, ACancelledUploadStoresNothing) {
  EXPECT_THAT(sequences().Upload(tube_, Progress({}, [] { return true; })),
              HasStatus(absl::StatusCode::kCancelled, _));
  EXPECT_TRUE(sequences().List()->empty());
}

TEST_F(LocalSequencesTest, EachLimitIsNamedAtBothDoors) {
  const int64_t size = static_cast<int64_t>(bytes_.size());
  for (const auto& [limits, flag] :
       {std::pair(ServiceLimits{.max_vertices = 95}, "max-vertices"),
        std::pair(ServiceLimits{.max_frames = 3}, "max-frames"),
        std::pair(ServiceLimits{.max_upload_bytes = size - 1}, "max-upload-bytes")}) {
    folder_.Open(limits);
    EXPECT_THAT(sequences().Upload(tube_, {}),
                HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr(flag)));
    EXPECT_FALSE(UploadBytes(id_, bytes_).ok()) << flag;
    EXPECT_EQ(sequences().QueryUpload(id_)->received_bytes, 0u) << flag;
    EXPECT_TRUE(sequences().List()->empty()) << flag;
  }
  // At the limit itself all is well.
  folder_.Open({.max_upload_bytes = size, .max_vertices = 96, .max_frames = 4});
  EXPECT_THAT(UploadBytes(id_, bytes_), IsOk());
  EXPECT_THAT(sequences().Upload(tube_, {}), IsOk());
}

TEST_F(LocalSequencesTest, ErrorsOfTheStoreArePassedOn) {
  ASSERT_THAT(sequences().Upload(tube_, {}), IsOk());
  ASSERT_THAT(folder_.files().catalog().Put(EntryKind::kSequence, {id_, "\xff\xff"}), IsOk());
  for (const absl::Status& status :
       {sequences().Get(id_).status(), sequences().Load(id_).status()}) {
    EXPECT_THAT(status, HasStatus(absl::StatusCode::kDataLoss, _));
  }
  EXPECT_FALSE(sequences().QueryUpload(id_)->complete);
  EXPECT_THAT(sequences().Upload(tube_, {}), IsOk());  // a new record mends it
  EXPECT_THAT(sequences().Get(id_), IsOk());
  const MeshSequence other = MakeSwayingTube(6);
  const std::string bytes = EncodeSequence(other), id = SequenceId(bytes);
  folder_.Block(id);
  EXPECT_THAT(sequences().Upload(other, {}).status().message(), HasSubstr("cannot create"));
  EXPECT_THAT(UploadBytes(id, bytes).message(), HasSubstr("cannot create"));
  EXPECT_EQ(sequences().List()->size(), 1u);
  folder_.Unblock(id);
  EXPECT_THAT(UploadBytes(id, bytes), IsOk());
}

// OK came back for content that was gone, and an upload of it was refused as known.
TEST_F(LocalSequencesTest, UploadingDamagedOrMissingContentAgainRepairsIt) {
  const std::function<void()> harms[] = {
      [&] { std::filesystem::remove(folder_.PathOf(id_)); },
      [&] {
        ASSERT_THAT(WriteFile(folder_.PathOf(id_), std::string(bytes_.size(), '?')), IsOk());
      }};
  for (const bool in_pieces : {true, false}) {
    for (const auto& harm : harms) {
      ASSERT_THAT(UploadBytes(id_, bytes_), IsOk());
      EXPECT_TRUE(sequences().QueryUpload(id_)->complete);
      harm();
      EXPECT_FALSE(sequences().QueryUpload(id_)->complete);
      ASSERT_THAT(in_pieces ? UploadBytes(id_, bytes_) : sequences().Upload(tube_, {}).status(),
                  IsOk());
      EXPECT_TRUE(sequences().QueryUpload(id_)->complete);
      EXPECT_THAT(sequences().Load(id_), IsOk());
    }
  }
}

TEST_F(LocalSequencesTest, ARowThatCannotBeReadHidesNoOther) {
  ASSERT_THAT(UploadBytes(id_, bytes_), IsOk());
  const std::string bad = std::string(64, 'b');
  ASSERT_THAT(folder_.files().catalog().Put(EntryKind::kSequence, {bad, "\xff\xff"}), IsOk());
  for (int round = 0; round < 2; ++round) {
    PLEAT_ASSERT_OK_AND_ASSIGN(const auto infos, sequences().List());
    ASSERT_EQ(infos.size(), 1u);
    EXPECT_EQ(infos[0].id, id_);
  }
  EXPECT_THAT(folder_.problems(), ElementsAre(HasSubstr(bad)));  // said once
  EXPECT_THAT(sequences().Get(bad), HasStatus(absl::StatusCode::kDataLoss, _));
  EXPECT_THAT(sequences().Delete(bad), IsOk());
}

// Six uploads that passed the check together left a disk without a byte.
TEST_F(LocalSequencesTest, UploadsReserveTheirRoom) {
  folder_.Open({.max_upload_bytes = int64_t{1} << 60});
  const uint64_t free_bytes = std::filesystem::space(folder_.path()).available;
  std::vector<std::unique_ptr<SequenceUpload>> uploads;
  for (const char digit : {'1', '2', '3', '4', '5', '6'}) {
    auto upload = sequences().BeginUpload(std::string(64, digit), free_bytes * 2 / 5, 0);
    if (upload.ok()) uploads.push_back(*std::move(upload));
  }
  EXPECT_EQ(uploads.size(), 2u);
  uploads.pop_back();  // gives its room back
  EXPECT_THAT(sequences().BeginUpload(std::string(64, '7'), free_bytes * 2 / 5, 0), IsOk());
}

}  // namespace
}  // namespace pleat
