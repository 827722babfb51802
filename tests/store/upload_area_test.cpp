#include "pleat/store/upload_area.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <filesystem>
#include <limits>
#include <thread>
#include <vector>

#include "pleat/base/file.h"
#include "pleat/base/random.h"
#include "pleat/base/sha256.h"
#include "pleat/base/wall_clock.h"
#include "pleat/store/blob_store.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

class UploadAreaTest : public testing::Test {
 protected:
  TemporaryFolder folder_;
  std::unique_ptr<UploadArea> area_ = UploadArea::Open(folder_.File("uploads")).value();
  BlobStore blobs_ = BlobStore::Open(folder_.File("blobs"), 0).value();
  const std::string content_ = "a sequence in a few bytes";
  const std::string id_ = ToHex(ComputeSha256(content_));
};

TEST_F(UploadAreaTest, GoesOnAfterABreakAndARestart) {
  {
    PLEAT_ASSERT_OK_AND_ASSIGN(auto upload, area_->Begin(id_, content_.size(), 0));
    ASSERT_THAT(upload->Append(content_.substr(0, 7)), IsOk());
  }
  area_ = UploadArea::Open(folder_.File("uploads")).value();
  EXPECT_EQ(area_->ReceivedBytes(id_), 7u);
  EXPECT_THAT(area_->Begin(id_, content_.size(), 9),
              HasStatus(absl::StatusCode::kOutOfRange, HasSubstr("has 7")));
  PLEAT_ASSERT_OK_AND_ASSIGN(auto upload, area_->Begin(id_, content_.size(), 7));
  EXPECT_THAT(upload->ReadComplete(),
              HasStatus(absl::StatusCode::kFailedPrecondition, HasSubstr("7 of 25")));
  ASSERT_THAT(upload->Append(content_.substr(7)), IsOk());
  EXPECT_EQ(upload->ReadComplete().value(), content_);
  PLEAT_ASSERT_OK_AND_ASSIGN(StagedFile file, upload->Stage());
  ASSERT_THAT(blobs_.Publish(std::move(file)), IsOk());
  EXPECT_EQ(blobs_.Get(id_).value(), content_);
  EXPECT_EQ(area_->ReceivedBytes(id_), 0u);
}

// An upload that could not be stored is not sent again.
TEST_F(UploadAreaTest, StagingKeepsTheBytesUntilTheyArePublished) {
  PLEAT_ASSERT_OK_AND_ASSIGN(auto upload, area_->Begin(id_, content_.size(), 0));
  ASSERT_THAT(upload->Append(content_), IsOk());
  { PLEAT_ASSERT_OK_AND_ASSIGN(const StagedFile unpublished, upload->Stage()); }
  EXPECT_EQ(area_->ReceivedBytes(id_), content_.size());
  EXPECT_EQ(upload->ReadComplete().value(), content_);
}

TEST_F(UploadAreaTest, OneWriterAtATime) {
  PLEAT_ASSERT_OK_AND_ASSIGN(auto upload, area_->Begin(id_, content_.size(), 0));
  ASSERT_THAT(upload->Append("abc"), IsOk());
  EXPECT_THAT(area_->Begin(id_, content_.size(), 0),
              HasStatus(absl::StatusCode::kAborted, HasSubstr("another call")));
  EXPECT_EQ(upload->received_bytes(), 3u);
  upload.reset();
  EXPECT_THAT(area_->Begin(id_, content_.size(), 3), IsOk());
}

TEST_F(UploadAreaTest, WrongContentStartsAgain) {
  {
    PLEAT_ASSERT_OK_AND_ASSIGN(auto upload, area_->Begin(id_, 3, 0));
    ASSERT_THAT(upload->Append("abc"), IsOk());
    EXPECT_THAT(upload->ReadComplete(),
                HasStatus(absl::StatusCode::kDataLoss, HasSubstr("SHA-256")));
  }
  EXPECT_EQ(area_->ReceivedBytes(id_), 0u);
  PLEAT_ASSERT_OK_AND_ASSIGN(auto upload, area_->Begin(id_, content_.size(), 0));
  ASSERT_THAT(upload->Append(content_), IsOk());
  EXPECT_EQ(upload->ReadComplete().value(), content_);
}

TEST_F(UploadAreaTest, MoreThanDeclaredIsRefused) {
  PLEAT_ASSERT_OK_AND_ASSIGN(auto upload, area_->Begin(id_, 3, 0));
  EXPECT_THAT(upload->Append("abcd"), HasStatus(absl::StatusCode::kOutOfRange, testing::_));
  EXPECT_EQ(upload->received_bytes(), 0u);
}

TEST_F(UploadAreaTest, RefusesIdsThatAreNoHash) {
  for (const char* id : {"", "../x", "abc"}) {
    EXPECT_THAT(area_->Begin(id, 3, 0),
                HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("hexadecimal")));
    EXPECT_EQ(area_->ReceivedBytes(id), 0u);
  }
}

TEST_F(UploadAreaTest, ForgetsOldUploadsThatNobodyWrites) {
  const std::string old(64, 'b'), held(64, 'a'), young(64, 'c');
  for (const std::string& id : {old, held, young}) {
    ASSERT_THAT((*area_->Begin(id, 10, 0))->Append("abc"), IsOk());
    if (id == young) continue;
    std::filesystem::last_write_time(
        folder_.File("uploads/" + id + ".part"),
        std::filesystem::file_time_type::clock::now() - std::chrono::hours(100));
  }
  ASSERT_THAT(WriteFile(folder_.File("uploads/notes.txt"), "not an upload"), IsOk());
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto upload, area_->Begin(held, 10, 3));
  const absl::Time now = SystemTime();
  EXPECT_THAT(area_->RemoveUntouchedSince(now - absl::Hours(101)), testing::IsEmpty());
  EXPECT_THAT(area_->RemoveUntouchedSince(now - absl::Hours(99)), testing::ElementsAre(old));
  EXPECT_EQ(area_->ReceivedBytes(old), 0u);
  EXPECT_EQ(area_->ReceivedBytes(held), 3u);
  EXPECT_EQ(area_->ReceivedBytes(young), 3u);
  EXPECT_TRUE(std::filesystem::exists(folder_.File("uploads/notes.txt")));
}

TEST_F(UploadAreaTest, AnUploadIsRemovedUnlessSomebodyWritesIt) {
  EXPECT_THAT(area_->Remove(id_), HasStatus(absl::StatusCode::kNotFound, HasSubstr(id_)));
  EXPECT_THAT(area_->Remove("../x"), HasStatus(absl::StatusCode::kInvalidArgument, testing::_));
  {
    PLEAT_ASSERT_OK_AND_ASSIGN(const auto upload, area_->Begin(id_, 10, 0));
    ASSERT_THAT(upload->Append("abc"), IsOk());
    EXPECT_THAT(area_->Remove(id_), HasStatus(absl::StatusCode::kAborted, testing::_));
  }
  EXPECT_THAT(area_->Remove(id_), IsOk());
  EXPECT_EQ(area_->ReceivedBytes(id_), 0u);
}

TEST_F(UploadAreaTest, PartsOfAnySizeAndAnyNumberOfBreaksGiveTheContent) {
  Random random(5);
  std::string content(10'000, '\0');
  for (char& byte : content) byte = static_cast<char>(random.UniformInt(256));
  const std::string id = ToHex(ComputeSha256(content));
  size_t sent = 0;
  while (sent < content.size()) {
    if (random.UniformInt(3) == 0) area_ = UploadArea::Open(folder_.File("uploads")).value();
    PLEAT_ASSERT_OK_AND_ASSIGN(auto upload, area_->Begin(id, content.size(), sent));
    for (int part = random.UniformInt(4); part > 0; --part) {
      const std::string bytes = content.substr(sent, random.UniformInt(700));
      ASSERT_THAT(upload->Append(bytes), IsOk());
      sent += bytes.size();
    }
    EXPECT_EQ(upload->received_bytes(), sent);
  }
  PLEAT_ASSERT_OK_AND_ASSIGN(auto upload, area_->Begin(id, content.size(), content.size()));
  EXPECT_EQ(upload->ReadComplete().value(), content);
}

TEST_F(UploadAreaTest, OffsetsThatDoNotFitLeaveWhatIsThere) {
  { ASSERT_THAT((*area_->Begin(id_, content_.size(), 0))->Append("a seq"), IsOk()); }
  const uint64_t most = std::numeric_limits<uint64_t>::max();
  for (const auto& [size_bytes, offset_bytes] :
       {std::pair<uint64_t, uint64_t>(25, 4), {25, 6}, {25, most}, {4, 5}, {most, most}}) {
    EXPECT_THAT(area_->Begin(id_, size_bytes, offset_bytes),
                HasStatus(absl::StatusCode::kOutOfRange, HasSubstr("has 5")));
    EXPECT_EQ(area_->ReceivedBytes(id_), 5u);
  }
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto upload, area_->Begin(id_, content_.size(), 0));
  EXPECT_EQ(area_->ReceivedBytes(id_), 0u);  // it has begun again
}

TEST_F(UploadAreaTest, BytesThatChangeOnTheDiskAreNoticedAndForgotten) {
  const std::string path = folder_.File("uploads/" + id_ + ".part");
  for (const std::string& damage : {std::string("A sequence in a few bytes"),  // another byte
                                    content_.substr(1), std::string()}) {
    PLEAT_ASSERT_OK_AND_ASSIGN(const auto upload, area_->Begin(id_, content_.size(), 0));
    ASSERT_THAT(upload->Append(content_), IsOk());
    std::filesystem::resize_file(path, 0);
    ASSERT_THAT(WriteFile(path, damage), IsOk());
    EXPECT_EQ(upload->ReadComplete().status().code(), absl::StatusCode::kDataLoss) << damage;
    EXPECT_EQ(area_->ReceivedBytes(id_), 0u);
  }
}

TEST_F(UploadAreaTest, OfManyWritersAtOnceOneBegins) {
  for (int round = 0; round < 20; ++round) {
    std::atomic<int> num_ready = 0, num_begun = 0, num_refused = 0;
    std::vector<std::thread> threads;
    for (int i = 0; i < 4; ++i) {
      threads.emplace_back([&] {
        ++num_ready;
        while (num_ready < 4) std::this_thread::yield();
        const auto upload = area_->Begin(id_, content_.size(), 0);
        ++(upload.ok() ? num_begun : num_refused);
        while (num_begun + num_refused < 4) std::this_thread::yield();  // it is held until then
      });
    }
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(num_begun, 1);
    EXPECT_EQ(num_refused, 3);
  }
}

}  // namespace
}  // namespace pleat
