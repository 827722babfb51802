// What every CharacterService promises about compression, wherever it runs.
#include <gtest/gtest.h>

#include <chrono>

#include "pleat/base/random.h"
#include "pleat/base/sha256.h"
#include "pleat/formats/sequence_file.h"
#include "pleat/sequence_codec/compress_sequence.h"
#include "pleat/sequence_codec/sequence_decoder.h"
#include "server/running_service.h"
#include "server/watch_to_end.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

class CompressionContractTest : public testing::TestWithParam<Reach> {
 protected:
  JobInfo WatchToEnd(const std::string& id) { return pleat::WatchToEnd(service_.jobs(), id); }
  // The id of the compressed sequence.
  std::string Compress(const MeshSequence& sequence, const CompressOptions& options) {
    const std::string id = service_.sequences().Upload(sequence, {})->id;
    const JobInfo job = WatchToEnd(service_.jobs().CreateCompression({id, options})->id);
    EXPECT_EQ(job.state, JobState::kSucceeded) << job.error;
    return job.result_id;
  }
  // The frames of a range; `shape` may be null.
  absl::StatusOr<std::vector<Eigen::Matrix3Xf>> Decode(const std::string& id, FrameRange range,
                                                       std::optional<MeshSequence>* shape) {
    std::vector<Eigen::Matrix3Xf> frames;
    const absl::Status status =
        DecodeFrames(service_.compressed_sequences(), id, range,
                     {.on_shape =
                          [&](const MeshSequence& first) {
                            if (shape != nullptr) shape->emplace(first);
                            return absl::OkStatus();
                          },
                      .on_frame =
                          [&](int t, const Eigen::Matrix3Xf& positions) {
                            EXPECT_EQ(t, range.begin + static_cast<int>(frames.size()));
                            frames.push_back(positions);
                            return absl::OkStatus();
                          }});
    if (!status.ok()) return status;
    return frames;
  }

  RunningService running_{GetParam()};
  CharacterService& service_ = running_.service();
  const std::string unknown_ = std::string(64, '0');
};

TEST_P(CompressionContractTest, AJobGivesTheBytesAndTheReportOfALocalRun) {
  const MeshSequence tube = MakeSwayingTube(40);
  const std::string sequence_id = SequenceId(EncodeSequence(tube));
  for (const CompressOptions& options :
       {CompressOptions{.goal = CompressionGoal::kMaxError, .max_error_mm = .5},
        CompressOptions{.goal = CompressionGoal::kKg, .kg_percent = 2, .keep_face_order = false},
        CompressOptions{.goal = CompressionGoal::kGrid, .grid_bits = 11}}) {
    CompressSummary summary;
    const std::string expected = CompressSequence(tube, options, &summary).value();
    const std::string id = Compress(tube, options);
    EXPECT_EQ(id, ToHex(ComputeSha256(expected)));
    PLEAT_ASSERT_OK_AND_ASSIGN(const std::string bytes,
                               service_.compressed_sequences().Download(id, {}));
    EXPECT_TRUE(bytes == expected);
    PLEAT_ASSERT_OK_AND_ASSIGN(const auto info, service_.compressed_sequences().Get(id));
    EXPECT_EQ(info.name, "tube");
    EXPECT_EQ(info.num_frames, 40);
    EXPECT_EQ(info.num_vertices, 96);
    EXPECT_EQ(info.num_faces, 88);
    EXPECT_EQ(info.frame_rate, (FrameRate{25, 1}));
    EXPECT_EQ(info.size_bytes, bytes.size());
    ASSERT_TRUE(info.record.has_value());
    EXPECT_EQ(info.record->sequence_id, sequence_id);
    EXPECT_EQ(info.record->options.goal, options.goal);
    EXPECT_EQ(info.record->options.keep_face_order, options.keep_face_order);
    EXPECT_EQ(info.record->summary.num_bytes, bytes.size());
    EXPECT_EQ(info.record->summary.max_error_mm, summary.max_error_mm);
    EXPECT_EQ(info.record->summary.kg_percent, summary.kg_percent);
    EXPECT_EQ(info.record->summary.bpvf, summary.bpvf);
    EXPECT_EQ(info.record->summary.num_topology_bytes, summary.num_topology_bytes);
    EXPECT_GT(info.record->encode_seconds, 0);
    EXPECT_GT(info.record->decode_seconds, 0);
  }
  EXPECT_EQ(service_.compressed_sequences().List()->size(), 3u);
  EXPECT_EQ(service_.jobs().List()->size(), 3u);
  EXPECT_EQ(service_.models().List()->size(), 0u);
}

TEST_P(CompressionContractTest, JobsOfBothKindsShareOneQueue) {
  const std::string id = service_.sequences().Upload(MakeSwayingTube(20), {})->id;
  running_.trainer().Hold();
  const std::string training =
      service_.jobs().CreateTraining({.sequence_ids = {id}, .model_name = "m"})->id;
  const std::string compression = service_.jobs().CreateCompression({id, {}})->id;
  running_.trainer().Release();
  EXPECT_EQ(WatchToEnd(compression).state, JobState::kSucceeded);
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto jobs, service_.jobs().List());
  ASSERT_EQ(jobs.size(), 2u);
  EXPECT_EQ(jobs[0].id, training);
  EXPECT_EQ(jobs[0].state, JobState::kSucceeded);
  EXPECT_TRUE(std::holds_alternative<TrainOptions>(jobs[0].options));
  EXPECT_EQ(jobs[1].sequence_ids, std::vector<std::string>{id});
  EXPECT_EQ(jobs[1].name, "tube");
  EXPECT_EQ(jobs[1].options, JobOptions(CompressOptions{}));
}

TEST_P(CompressionContractTest, AnyRangeGivesTheFramesOfTheWholeFile) {
  // 600 frames: more than a segment. 3000 vertices: frames of the large tube fill several chunks.
  const MeshSequence tube = MakeSwayingTube(600);
  const std::string id = Compress(tube, {.max_error_mm = 2});
  SequenceDecoder decoder =
      SequenceDecoder::Open(service_.compressed_sequences().Download(id, {}).value()).value();
  const MeshSequence whole = decoder.DecodeAll().value();
  Random random(2);
  std::vector<FrameRange> ranges = {{0, 0}, {599, 600}, {510, 514}, {590, 0}};
  for (int i = 0; i < 6; ++i) {
    const int begin = random.UniformInt(600);
    ranges.push_back({begin, begin + 1 + random.UniformInt(std::min(600 - begin, 40))});
  }
  for (const FrameRange& range : ranges) {
    std::optional<MeshSequence> shape;
    PLEAT_ASSERT_OK_AND_ASSIGN(const auto frames, Decode(id, range, &shape));
    const int end = range.end == 0 ? 600 : range.end;
    ASSERT_EQ(static_cast<int>(frames.size()), end - range.begin);
    for (int t = range.begin; t < end; ++t) {
      ASSERT_EQ(frames[t - range.begin], whole.frame(t)) << t;
    }
    EXPECT_TRUE(shape->topology() == whole.topology());
    EXPECT_EQ(shape->name(), "tube");
    EXPECT_EQ(shape->frame_rate(), tube.frame_rate());
    EXPECT_EQ(shape->frame(0), whole.frame(range.begin));
  }
  EXPECT_EQ(running_.local().compressed_sequences().decoder_bytes(), 0u);
}

TEST_P(CompressionContractTest, FramesAndShapesOfManyChunksArriveWhole) {
  const MeshSequence large = MakeSwayingTube(3, "large", 500, 100);  // 600 kB per frame
  const std::string id = Compress(large, {.goal = CompressionGoal::kGrid, .grid_bits = 10});
  SequenceDecoder decoder =
      SequenceDecoder::Open(service_.compressed_sequences().Download(id, {}).value()).value();
  const MeshSequence whole = decoder.DecodeAll().value();
  std::optional<MeshSequence> shape;
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto frames, Decode(id, {1, 3}, &shape));
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_EQ(frames[0], whole.frame(1));
  EXPECT_EQ(frames[1], whole.frame(2));
  EXPECT_TRUE(shape->topology() == large.topology());
}

TEST_P(CompressionContractTest, AFileCanBeUploadedAndDecodedThere) {
  const MeshSequence tube = MakeSwayingTube(20);
  const std::string file = CompressSequence(tube, {.max_error_mm = 1}, nullptr).value();
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto info, service_.compressed_sequences().Upload(file, {}));
  EXPECT_EQ(info.id, ToHex(ComputeSha256(file)));
  EXPECT_EQ(info.num_frames, 20);
  EXPECT_FALSE(info.record.has_value());
  EXPECT_EQ(service_.compressed_sequences().Upload(file, {})->id, info.id);
  EXPECT_EQ(Decode(info.id, {3, 5}, nullptr)->size(), 2u);
  // A job that gives the same file adds its report, and an upload does not take it away.
  EXPECT_EQ(Compress(tube, {.max_error_mm = 1}), info.id);
  EXPECT_TRUE(service_.compressed_sequences().Get(info.id)->record.has_value());
  EXPECT_TRUE(service_.compressed_sequences().Upload(file, {})->record.has_value());
  EXPECT_EQ(service_.compressed_sequences().List()->size(), 1u);

  EXPECT_THAT(service_.compressed_sequences().Delete(info.id), IsOk());
  EXPECT_THAT(service_.compressed_sequences().Delete(info.id),
              HasStatus(absl::StatusCode::kNotFound, testing::_));
  EXPECT_THAT(Decode(info.id, {}, nullptr), HasStatus(absl::StatusCode::kNotFound, testing::_));
}

TEST_P(CompressionContractTest, HostileFilesAreRefusedAndForgotten) {
  const std::string good =
      CompressSequence(MakeSwayingTube(20), {.max_error_mm = 1}, nullptr).value();
  std::string damaged = good;
  damaged[good.size() / 2] ^= 0x10;
  // Draco is nothing that a server reads.
  const std::string draco = std::string("DRACO\x02\x02\x01\x01\x00\x00", 11) + std::string(50, 'x');
  for (const std::string& bytes :
       {std::string("x"), draco, damaged, good + "x", good.substr(0, good.size() - 5),
        EncodeSequence(MakeSwayingTube(3))}) {
    EXPECT_FALSE(service_.compressed_sequences().Upload(bytes, {}).ok());
    EXPECT_EQ(running_.local().sequences().QueryUpload(ToHex(ComputeSha256(bytes)))->received_bytes,
              0u);
  }
  EXPECT_TRUE(service_.compressed_sequences().List()->empty());
  EXPECT_EQ(running_.local().compressed_sequences().decoder_bytes(), 0u);
}

TEST_P(CompressionContractTest, BadRequestsAreRefusedAlike) {
  const std::string id = service_.sequences().Upload(MakeSwayingTube(5), {})->id;
  EXPECT_THAT(service_.jobs().CreateCompression({unknown_, {}}),
              HasStatus(absl::StatusCode::kNotFound, HasSubstr("sequence")));
  EXPECT_THAT(service_.jobs().CreateCompression({id, {.max_error_mm = 0}}),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("max_error_mm")));
  EXPECT_THAT(service_.jobs().CreateCompression(
                  {id, {.goal = CompressionGoal::kKg, .kg_percent = 0.0 / 0.0}}),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("kg_percent")));
  EXPECT_THAT(
      service_.jobs().CreateCompression({id, {.goal = CompressionGoal::kGrid, .grid_bits = 99}}),
      HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("grid_bits")));
  EXPECT_THAT(service_.compressed_sequences().Get(unknown_),
              HasStatus(absl::StatusCode::kNotFound, testing::_));
  EXPECT_THAT(service_.compressed_sequences().Download(unknown_, {}),
              HasStatus(absl::StatusCode::kNotFound, testing::_));
  EXPECT_THAT(Decode(unknown_, {}, nullptr), HasStatus(absl::StatusCode::kNotFound, testing::_));
  const std::string compressed = Compress(MakeSwayingTube(5), {});
  for (const FrameRange range : {FrameRange{-1, 2}, {5, 6}, {2, 2}, {3, 1}, {0, 6}}) {
    EXPECT_THAT(Decode(compressed, range, nullptr),
                HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("which has 5")));
  }
  // A promise that float32 cannot keep fails the job with its reason.
  const JobInfo job =
      WatchToEnd(service_.jobs().CreateCompression({id, {.max_error_mm = .001}})->id);
  EXPECT_EQ(job.state, JobState::kFailed);
  EXPECT_THAT(job.error, HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("float32")));
}

TEST_P(CompressionContractTest, CancellationActsWithinASecond) {
  const std::string id =
      service_.sequences().Upload(MakeSwayingTube(200, "large", 100, 60), {})->id;
  const std::string job = service_.jobs().CreateCompression({id, {.max_error_mm = .1}})->id;
  ASSERT_THAT(
      WatchJob(service_.jobs(), job, [](const JobInfo& info) { return info.stage != "encode"; }),
      IsOk());
  ASSERT_FALSE(IsFinal(service_.jobs().Get(job)->state));
  const auto start = std::chrono::steady_clock::now();
  EXPECT_THAT(service_.jobs().Cancel(job), IsOk());
  EXPECT_EQ(WatchToEnd(job).state, JobState::kCancelled);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(1));
  EXPECT_TRUE(service_.compressed_sequences().List()->empty());
}

TEST_P(CompressionContractTest, TheSinkMayStopDecoding) {
  const std::string id = Compress(MakeSwayingTube(100), {});
  int num_frames = 0;
  EXPECT_THAT(DecodeFrames(service_.compressed_sequences(), id, {},
                           {.on_shape = [](const MeshSequence&) { return absl::OkStatus(); },
                            .on_frame =
                                [&](int t, const Eigen::Matrix3Xf&) {
                                  ++num_frames;
                                  return t == 3 ? absl::AbortedError("seen enough")
                                                : absl::OkStatus();
                                }}),
              HasStatus(absl::StatusCode::kAborted, HasSubstr("seen enough")));
  EXPECT_EQ(num_frames, 4);
}

INSTANTIATE_TEST_SUITE_P(Reach, CompressionContractTest,
                         testing::Values(Reach::kLocal, Reach::kInProcess, Reach::kSocket),
                         [](const auto& info) { return ReachName(info.param); });

}  // namespace
}  // namespace pleat
