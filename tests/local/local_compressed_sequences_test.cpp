#include "pleat/local/local_compressed_sequences.h"

#include <gtest/gtest.h>

#include "data_folder.h"
#include "pleat/base/sha256.h"
#include "pleat/local/job_runner.h"
#include "support/fake_training.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::_;
using ::testing::HasSubstr;

class LocalCompressedSequencesTest : public testing::Test {
 protected:
  LocalCompressedSequencesTest() { Open({}, 1 << 30); }
  void Open(const ServiceLimits& limits, uint64_t decode_bytes) {
    compressed_.reset();
    folder_.Open(limits);
    memory_ = std::make_unique<MemoryBudget>(decode_bytes, "--decode-bytes");
    compressed_ = std::make_unique<LocalCompressedSequences>(&folder_.files(), memory_.get());
  }

  DataFolder folder_;
  std::unique_ptr<MemoryBudget> memory_;
  std::unique_ptr<LocalCompressedSequences> compressed_;
  const MeshSequence tube_ = MakeSwayingTube(10);
  const std::string file_ = CompressSequence(tube_, {}, nullptr).value();
  const std::string id_ = ToHex(ComputeSha256(file_));
};

TEST_F(LocalCompressedSequencesTest, AFileIsDescribedByWhatItHolds) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const CompressedSequenceInfo info, compressed_->Upload(file_, {}));
  EXPECT_EQ(info.id, id_);
  EXPECT_EQ(info.name, "tube");
  EXPECT_EQ(info.num_frames, 10);
  EXPECT_EQ(info.num_vertices, 96);
  EXPECT_EQ(info.num_faces, 88);
  EXPECT_EQ(info.size_bytes, file_.size());
  EXPECT_FALSE(info.record.has_value());
  EXPECT_TRUE(compressed_->Download(id_, {}).value() == file_);
  EXPECT_TRUE(compressed_->OpenDownload(id_, 7).value()->Next().value() == file_.substr(7));
  EXPECT_EQ(compressed_->decoder_bytes(), 0u);
  EXPECT_THAT(compressed_->Delete(id_), IsOk());
  EXPECT_THAT(compressed_->Download(id_, {}), HasStatus(absl::StatusCode::kNotFound, _));
  EXPECT_THAT(compressed_->OpenDecode(id_, {}), HasStatus(absl::StatusCode::kNotFound, _));
}

// What a job has measured must survive that somebody uploads the same file.
TEST_F(LocalCompressedSequencesTest, TheRecordOfAJobStays) {
  const std::string sequence_id = folder_.sequences().Upload(tube_, {})->id;
  FakeTrainer trainer;
  const JobRunner runner(&folder_.files(), &folder_.sequences(), trainer.function(), 1);
  JobInfo job;
  job.sequence_ids = {sequence_id};
  job.options = CompressOptions();
  PLEAT_ASSERT_OK_AND_ASSIGN(const JobOutcome outcome, runner.Run(job, {}));
  ASSERT_EQ(outcome.result_id, id_);
  PLEAT_ASSERT_OK_AND_ASSIGN(const CompressedSequenceInfo again, compressed_->Upload(file_, {}));
  ASSERT_TRUE(again.record.has_value());
  EXPECT_EQ(again.record->sequence_id, sequence_id);
  EXPECT_EQ(compressed_->Get(id_)->record->sequence_id, sequence_id);
  EXPECT_EQ(folder_.sequences().QueryUpload(id_)->complete, true);
}

TEST_F(LocalCompressedSequencesTest, FilesAboveALimitAreRefusedAndForgotten) {
  for (const ServiceLimits& limits :
       {ServiceLimits{.max_vertices = 95}, ServiceLimits{.max_frames = 9}}) {
    Open(limits, 1 << 30);
    EXPECT_FALSE(compressed_->Upload(file_, {}).ok());
    EXPECT_EQ(folder_.sequences().QueryUpload(id_)->received_bytes, 0u);
    EXPECT_TRUE(compressed_->List()->empty());
  }
  Open({.max_vertices = 96, .max_frames = 10}, 1 << 30);
  EXPECT_THAT(compressed_->Upload(file_, {}), IsOk());
}

// Too little memory to look at a file now: it is kept, and the upload can be finished later.
TEST_F(LocalCompressedSequencesTest, AnUploadThatCannotBeCheckedNowCanBeLater) {
  Open({}, file_.size() - 1);
  EXPECT_THAT(compressed_->Upload(file_, {}),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("checking the upload")));
  EXPECT_EQ(compressed_->decoder_bytes(), 0u);
  EXPECT_EQ(folder_.sequences().QueryUpload(id_)->received_bytes, file_.size());
  Open({}, 1 << 30);
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto upload,
                             compressed_->BeginUpload(id_, file_.size(), file_.size()));
  EXPECT_EQ(upload->Finish()->id, id_);
}

TEST_F(LocalCompressedSequencesTest, RangesThatAreNotInsideAreRefusedAndTakeNoMemory) {
  ASSERT_THAT(compressed_->Upload(file_, {}), IsOk());
  for (const FrameRange& wrong : {FrameRange{-1, 3}, FrameRange{10, 0}, FrameRange{3, 3},
                                  FrameRange{5, 2}, FrameRange{0, 11}, FrameRange{1 << 30, 0}}) {
    EXPECT_THAT(compressed_->OpenDecode(id_, wrong),
                HasStatus(absl::StatusCode::kInvalidArgument, _))
        << wrong.begin << " to " << wrong.end;
    EXPECT_EQ(compressed_->decoder_bytes(), 0u);
  }
  for (const auto& [range, count] : {std::pair(FrameRange{}, 10), std::pair(FrameRange{9, 10}, 1),
                                     std::pair(FrameRange{4, 0}, 6)}) {
    PLEAT_ASSERT_OK_AND_ASSIGN(const auto session, compressed_->OpenDecode(id_, range));
    PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence shape, session->Shape());
    EXPECT_EQ(shape.num_vertices(), 96);
    int num_frames = 0;
    for (;; ++num_frames) {
      PLEAT_ASSERT_OK_AND_ASSIGN(const Eigen::Matrix3Xf* const frame, session->Next());
      if (frame == nullptr) break;
      const Eigen::Matrix3Xf& original = tube_.frame(range.begin + num_frames);
      EXPECT_LT((*frame - original).cwiseAbs().maxCoeff(), .002);
    }
    EXPECT_EQ(num_frames, count);
  }
}

TEST_F(LocalCompressedSequencesTest, ErrorsOfTheStoreArePassedOnAndTakeNoMemory) {
  ASSERT_THAT(compressed_->Upload(file_, {}), IsOk());
  std::filesystem::resize_file(folder_.PathOf(id_), file_.size() / 2);
  EXPECT_THAT(compressed_->OpenDecode(id_, {}), HasStatus(absl::StatusCode::kDataLoss, _));
  EXPECT_EQ(compressed_->decoder_bytes(), 0u);
  ASSERT_THAT(compressed_->Upload(file_, {}), IsOk());  // mends it
  std::filesystem::resize_file(folder_.PathOf(id_), file_.size() / 2);
  EXPECT_THAT(compressed_->Download(id_, {}), HasStatus(absl::StatusCode::kDataLoss, _));
  ASSERT_THAT(folder_.files().catalog().Put(EntryKind::kCompressedSequence, {id_, "\xff"}), IsOk());
  EXPECT_THAT(compressed_->Get(id_), HasStatus(absl::StatusCode::kDataLoss, _));
  EXPECT_TRUE(compressed_->List()->empty());  // one bad row hides no other
}

TEST_F(LocalCompressedSequencesTest, ACancelledUploadStoresNothing) {
  EXPECT_THAT(compressed_->Upload(file_, Progress({}, [] { return true; })),
              HasStatus(absl::StatusCode::kCancelled, _));
  EXPECT_TRUE(compressed_->List()->empty());
}

}  // namespace
}  // namespace pleat
