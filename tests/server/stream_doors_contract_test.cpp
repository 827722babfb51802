// What every CharacterService promises about the finer doors: files in pieces, subscriptions,
// sessions of poses.
#include <gtest/gtest.h>

#include "pleat/base/sha256.h"
#include "pleat/formats/sequence_file.h"
#include "pleat/sequence_codec/compress_sequence.h"
#include "pleat/stream/frame_decoder.h"
#include "server/running_service.h"
#include "server/watch_to_end.h"
#include "support/random_data.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::_;
using ::testing::HasSubstr;

class StreamDoorsContractTest : public testing::TestWithParam<Reach> {
 protected:
  static std::string ReadRest(absl::StatusOr<std::unique_ptr<ContentDownload>> download) {
    EXPECT_THAT(download, IsOk());
    std::string bytes;
    while (download.ok()) {
      const std::string part = (*download)->Next().value();
      if (part.empty()) break;
      bytes += part;
    }
    return bytes;
  }

  RunningService running_{GetParam()};
  CharacterService& service_ = running_.service();
  const std::string unknown_ = std::string(64, '0');
};

TEST_P(StreamDoorsContractTest, ASequenceArrivesInPieces) {
  const std::string bytes = EncodeSequence(MakeSwayingTube(60, "large", 100, 30));  // 2 MB
  const std::string id = SequenceId(bytes);
  SequenceService& sequences = service_.sequences();
  EXPECT_EQ(sequences.QueryUpload(id)->received_bytes, 0u);
  {
    PLEAT_ASSERT_OK_AND_ASSIGN(const auto upload, sequences.BeginUpload(id, bytes.size(), 0));
    ASSERT_THAT(upload->Append(std::string_view(bytes).substr(0, 1'000'000)), IsOk());
    EXPECT_EQ(upload->received_bytes(), 1'000'000u);
    EXPECT_THAT(upload->Finish(), HasStatus(absl::StatusCode::kFailedPrecondition, _));
  }
  const uint64_t received = sequences.QueryUpload(id)->received_bytes;
  EXPECT_EQ(received, 1'000'000u);
  EXPECT_FALSE(sequences.QueryUpload(id)->complete);
  {
    PLEAT_ASSERT_OK_AND_ASSIGN(const auto upload,
                               sequences.BeginUpload(id, bytes.size(), received));
    ASSERT_THAT(upload->Append(std::string_view(bytes).substr(received)), IsOk());
    EXPECT_EQ(upload->Finish()->num_vertices, 3000);
  }
  EXPECT_TRUE(sequences.QueryUpload(id)->complete);
  EXPECT_EQ(sequences.List()->size(), 1u);
}

TEST_P(StreamDoorsContractTest, BytesThatAreNoSequenceAreRefusedAtTheEnd) {
  const std::string bytes = "no sequence";
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto upload,
                             service_.sequences().BeginUpload(SequenceId(bytes), bytes.size(), 0));
  ASSERT_THAT(upload->Append(bytes), IsOk());
  EXPECT_THAT(upload->Finish(), HasStatus(absl::StatusCode::kInvalidArgument, _));
  EXPECT_TRUE(service_.sequences().List()->empty());
}

TEST_P(StreamDoorsContractTest, ACompressedSequenceArrivesInPiecesAndLeavesInPieces) {
  const std::string file =
      CompressSequence(MakeSwayingTube(20), {.max_error_mm = 1}, nullptr).value();
  const std::string id = ToHex(ComputeSha256(file));
  CompressedSequenceService& compressed = service_.compressed_sequences();
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto upload, compressed.BeginUpload(id, file.size(), 0));
  ASSERT_THAT(upload->Append(file), IsOk());
  EXPECT_EQ(upload->Finish()->num_frames, 20);
  EXPECT_TRUE(ReadRest(compressed.OpenDownload(id, 0)) == file);
  EXPECT_EQ(ReadRest(compressed.OpenDownload(id, file.size() - 4)), file.substr(file.size() - 4));
  EXPECT_THAT(compressed.OpenDownload(unknown_, 0), HasStatus(absl::StatusCode::kNotFound, _));
}

TEST_P(StreamDoorsContractTest, ASequenceLeavesInPiecesAsItCame) {
  const MeshSequence tube = MakeSwayingTube(5, "tube", 40, 30);
  const std::string bytes = EncodeSequence(tube);
  SequenceService& sequences = service_.sequences();
  const std::string id = sequences.Upload(tube, {})->id;
  EXPECT_EQ(sequences.OpenDownload(id, 0).value()->size_bytes(), bytes.size());
  EXPECT_TRUE(ReadRest(sequences.OpenDownload(id, 0)) == bytes);
  EXPECT_TRUE(ReadRest(sequences.OpenDownload(id, 100)) == bytes.substr(100));
  EXPECT_THAT(sequences.OpenDownload(id, bytes.size() + 1),
              HasStatus(absl::StatusCode::kOutOfRange, _));
  EXPECT_THAT(sequences.OpenDownload(unknown_, 0), HasStatus(absl::StatusCode::kNotFound, _));
}

TEST_P(StreamDoorsContractTest, AModelLeavesInPieces) {
  const std::string id = running_.TrainModel(MakeSwayingTube(5, "tube", 40, 30));
  const std::string bytes = service_.models().Download(id, {}).value();
  ASSERT_GT(bytes.size(), 1000u);
  EXPECT_EQ(service_.models().OpenDownload(id, 0).value()->size_bytes(), bytes.size());
  EXPECT_TRUE(ReadRest(service_.models().OpenDownload(id, 100)) == bytes.substr(100));
  EXPECT_EQ(ReadRest(service_.models().OpenDownload(id, bytes.size())), "");
  EXPECT_THAT(service_.models().OpenDownload(id, bytes.size() + 1),
              HasStatus(absl::StatusCode::kOutOfRange, _));
}

TEST_P(StreamDoorsContractTest, ADownloadThatHasBegunEndsWhateverIsDeleted) {
  // Noise is hard to compress: the file is more than a server sends before anybody reads.
  const MeshSequence tube = MakeSwayingTube(100, "long", 60, 40);
  std::vector<Eigen::Matrix3Xf> frames;
  for (int t = 0; t < tube.num_frames(); ++t) {
    const Eigen::MatrixXd noise = RandomMatrix(3, tube.num_vertices(), static_cast<uint64_t>(t));
    frames.push_back(tube.frame(t) + .05f * noise.cast<float>());
  }
  const MeshSequence noisy =
      MeshSequence::Create(tube.topology(), std::move(frames), {.name = "long"}).value();
  const CompressOptions exact{.goal = CompressionGoal::kGrid, .grid_bits = 20};
  const std::string file = CompressSequence(noisy, exact, nullptr).value();
  ASSERT_GT(file.size(), 3u * kDownloadPieceBytes);
  CompressedSequenceService& compressed = service_.compressed_sequences();
  const std::string id = compressed.Upload(file, {})->id;
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto download, compressed.OpenDownload(id, 0));
  std::string bytes = download->Next().value();
  ASSERT_THAT(compressed.Delete(id), IsOk());
  while (bytes.size() < file.size()) {
    PLEAT_ASSERT_OK_AND_ASSIGN(const std::string part, download->Next());
    ASSERT_FALSE(part.empty());
    bytes += part;
  }
  EXPECT_TRUE(bytes == file);
  EXPECT_THAT(compressed.OpenDownload(id, 0), HasStatus(absl::StatusCode::kNotFound, _));
}

TEST_P(StreamDoorsContractTest, ASubscriptionShowsAJobUntilItIsFinal) {
  const std::string sequence = service_.sequences().Upload(MakeSwayingTube(5), {})->id;
  running_.trainer().Hold();
  const std::string job = service_.jobs().CreateTraining({.sequence_ids = {sequence}})->id;
  std::atomic<int> num_rings = 0;
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto subscription,
                             service_.jobs().Subscribe(job, [&] { ++num_rings; }));
  running_.trainer().Release();
  EXPECT_EQ(WatchToEnd(service_.jobs(), job).state, JobState::kSucceeded);
  // The two observers of a server are told in no certain order.
  uint64_t revision = 0;
  while (true) {
    const JobUpdate update = subscription->current();
    EXPECT_GE(update.revision, revision);
    revision = update.revision;
    if (IsFinal(update.info.state)) break;
    std::this_thread::yield();
  }
  EXPECT_EQ(subscription->current().info.id, job);
  EXPECT_THAT(subscription->status(), IsOk());
  EXPECT_GT(num_rings, 0);
  EXPECT_THAT(service_.jobs().Subscribe("job-none", [] {}),
              HasStatus(absl::StatusCode::kNotFound, _));
}

TEST_P(StreamDoorsContractTest, SinglePosesAreFramesOfOneSession) {
  const std::string id = running_.TrainModel();
  const auto model = running_.local().models().Acquire(id).value();
  const PoseTrack track = MakeMotion(model->skeleton(), 3);
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto session,
                             service_.poses().OpenSession(id, {.encoder = {.position_bits = 16}}));
  PLEAT_ASSERT_OK_AND_ASSIGN(FrameDecoder decoder, FrameDecoder::Create(session->header()));
  for (int t = 1; t < 3; ++t) {
    PLEAT_ASSERT_OK_AND_ASSIGN(const EncodedFrame frame,
                               session->Show({&track.pose(t), &track.pose(t - 1)}));
    EvaluatedFrame truth;
    ASSERT_THAT(PoseEvaluator(model).Evaluate({&track.pose(t), &track.pose(t - 1)}, {}, &truth),
                IsOk());
    Eigen::Matrix3Xf positions;
    ASSERT_THAT(decoder.Decode(frame.draco, frame.mark, &positions), IsOk());
    EXPECT_LE((positions - truth.positions).cwiseAbs().maxCoeff(), 2e-5);
    EXPECT_EQ(frame.confidence, truth.confidence);
  }
  Pose short_pose = track.pose(0);
  short_pose.rotations.pop_back();
  EXPECT_THAT(session->Show({&short_pose}), HasStatus(absl::StatusCode::kInvalidArgument, _));
  EXPECT_THAT(service_.poses().OpenSession(unknown_, {}),
              HasStatus(absl::StatusCode::kNotFound, _));
}

TEST_P(StreamDoorsContractTest, AClipIsASessionThatEnds) {
  const std::string id = running_.TrainModel();
  const auto model = running_.local().models().Acquire(id).value();
  const PoseTrack track = MakeMotion(model->skeleton(), 4);
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto clip, service_.poses().OpenClip(id, track, {}));
  EXPECT_EQ(clip->header().num_vertices, model->num_vertices());
  for (int t = 0; t < 4; ++t) {
    ASSERT_FALSE(clip->done());
    EXPECT_EQ(clip->next_frame(), t);
    EXPECT_FALSE(clip->Next()->draco.empty());
  }
  EXPECT_TRUE(clip->done());
  PoseTrack::Parts parts = track.parts();
  for (Pose& pose : parts.poses) pose.rotations.pop_back();
  EXPECT_THAT(service_.poses().OpenClip(id, PoseTrack::FromValid(std::move(parts)), {}),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("frame 0")));
}

INSTANTIATE_TEST_SUITE_P(Reach, StreamDoorsContractTest,
                         testing::Values(Reach::kLocal, Reach::kInProcess, Reach::kSocket),
                         [](const auto& info) { return ReachName(info.param); });

}  // namespace
}  // namespace pleat
