#include "pleat/service/compression.h"

#include <gtest/gtest.h>

#include "support/fake_training.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

SequenceDecoder Compressed(int num_frames) {
  return SequenceDecoder::Open(
             CompressSequence(MakeSwayingTube(num_frames), {.max_error_mm = 1}, nullptr).value())
      .value();
}

TEST(CompressMeasured, GivesTheBytesOfTheCodecAndTimes) {
  const MeshSequence tube = MakeSwayingTube(8);
  const CompressOptions options{.max_error_mm = 1};
  CompressSummary summary;
  const std::string expected = CompressSequence(tube, options, &summary).value();
  std::string stage;
  const Progress progress([&](const ProgressUpdate& update) { stage = update.stage; }, {});
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeasuredCompression measured,
                             CompressMeasured(tube, options, progress));
  EXPECT_TRUE(measured.bytes == expected);
  EXPECT_EQ(measured.record.options, options);
  EXPECT_EQ(measured.record.summary.max_error_mm, summary.max_error_mm);
  EXPECT_EQ(measured.record.sequence_id, "");
  EXPECT_GT(measured.record.encode_seconds, 0);
  EXPECT_GT(measured.record.decode_seconds, 0);
  EXPECT_EQ(stage, "decode");
}

TEST(DecodeInto, GivesShapeAndFramesOfTheRange) {
  const MeshSequence whole = Compressed(8).DecodeAll().value();
  for (const FrameRange range : {FrameRange{}, {3, 5}, {7, 0}}) {
    PLEAT_ASSERT_OK_AND_ASSIGN(const auto session, MakeDecodeSession(Compressed(8), range));
    int next = range.begin, num_shapes = 0;
    EXPECT_THAT(DecodeInto(*session, range,
                           {.on_shape =
                                [&](const MeshSequence& shape) {
                                  ++num_shapes;
                                  EXPECT_EQ(shape.num_frames(), 1);
                                  EXPECT_EQ(shape.name(), "tube");
                                  EXPECT_EQ(shape.frame(0), whole.frame(range.begin));
                                  return absl::OkStatus();
                                },
                            .on_frame =
                                [&](int t, const Eigen::Matrix3Xf& positions) {
                                  EXPECT_EQ(t, next++);
                                  EXPECT_EQ(positions, whole.frame(t));
                                  return absl::OkStatus();
                                }}),
                IsOk());
    EXPECT_EQ(num_shapes, 1);
    EXPECT_EQ(next, range.end == 0 ? 8 : range.end);
  }
}

TEST(MakeDecodeSession, RefusesARangeThatIsNotInside) {
  for (const FrameRange range : {FrameRange{-1, 2}, {8, 9}, {2, 2}, {3, 1}, {0, 9}}) {
    EXPECT_THAT(MakeDecodeSession(Compressed(8), range),
                HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("which has 8")));
  }
}

TEST(CompressMeasured, EveryGoalIsMeasuredOnTheFileItGives) {
  const MeshSequence tube = MakeSwayingTube(6);
  for (const CompressOptions& options :
       {CompressOptions{.goal = CompressionGoal::kMaxError, .max_error_mm = .5},
        CompressOptions{.goal = CompressionGoal::kKg, .kg_percent = 2},
        CompressOptions{.goal = CompressionGoal::kGrid, .grid_bits = 11}}) {
    PLEAT_ASSERT_OK_AND_ASSIGN(const MeasuredCompression measured,
                               CompressMeasured(tube, options, {}));
    EXPECT_EQ(measured.record.summary.num_bytes, measured.bytes.size());
    EXPECT_LT(measured.record.summary.num_topology_bytes, measured.bytes.size());
    if (options.goal == CompressionGoal::kMaxError) {
      EXPECT_LE(measured.record.summary.max_error_mm, .5);
    }
    if (options.goal == CompressionGoal::kKg) {
      EXPECT_LE(measured.record.summary.kg_percent, 2);
    }
    PLEAT_ASSERT_OK_AND_ASSIGN(SequenceDecoder decoder, SequenceDecoder::Open(measured.bytes));
    PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence back, decoder.DecodeAll());
    double worst_mm = 0;
    for (int t = 0; t < back.num_frames(); ++t) {
      const double off = (back.frame(t) - tube.frame(t)).colwise().norm().maxCoeff();
      worst_mm = std::max(worst_mm, 1000 * off);
    }
    EXPECT_NEAR(worst_mm, measured.record.summary.max_error_mm, 1e-3);
  }
}

TEST(CompressMeasured, RefusesAnOptionOutOfRange) {
  EXPECT_THAT(CompressMeasured(MakeSwayingTube(2), {.max_error_mm = 0}, {}),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("max_error_mm")));
}

TEST(CompressMeasured, FractionsRiseAndEveryStageCanBeCancelled) {
  std::vector<std::string> stages;
  double last = 0;
  const Progress progress(
      [&](const ProgressUpdate& update) {
        EXPECT_GE(update.fraction, last) << update.stage;
        last = update.fraction;
        if (stages.empty() || stages.back() != update.stage) stages.push_back(update.stage);
      },
      {});
  const MeshSequence tube = MakeSwayingTube(6);
  ASSERT_THAT(CompressMeasured(tube, {}, progress), IsOk());
  EXPECT_GE(last, .9);  // "decode" covers the rest
  ASSERT_GE(stages.size(), 3u);
  EXPECT_THAT((std::vector<std::string>{stages.end() - 3, stages.end()}),
              testing::ElementsAre("encode", "check", "decode"));
  for (const std::string& stage : stages) {
    bool reached = false;
    const Progress stopping(
        [&](const ProgressUpdate& update) { reached = reached || update.stage == stage; },
        [&] { return reached; });
    // The last report of the last stage has nothing after it that could be stopped.
    if (stage == stages.back()) continue;
    EXPECT_THAT(CompressMeasured(tube, {}, stopping),
                HasStatus(absl::StatusCode::kCancelled, testing::_))
        << stage;
  }
}

TEST(MakeDecodeSession, StaysAtItsEnd) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto session, MakeDecodeSession(Compressed(8), {6, 8}));
  for (const bool is_frame : {true, true, false, false}) {
    PLEAT_ASSERT_OK_AND_ASSIGN(const Eigen::Matrix3Xf* frame, session->Next());
    EXPECT_EQ(frame != nullptr, is_frame);
  }
}

TEST(MakeDecodeSession, TheShapeTakesNoFrameAndHasTheNamesOfTheSequence) {
  const MeshSequence tube = MakeSwayingTube(8);
  PLEAT_ASSERT_OK_AND_ASSIGN(const auto session, MakeDecodeSession(Compressed(8), {5, 6}));
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence shape, session->Shape());
  EXPECT_TRUE(shape.topology() == tube.topology());
  EXPECT_EQ(shape.frame_rate(), tube.frame_rate());
  PLEAT_ASSERT_OK_AND_ASSIGN(const Eigen::Matrix3Xf* frame, session->Next());
  ASSERT_NE(frame, nullptr);
  EXPECT_EQ(*frame, shape.frame(0));
}

}  // namespace
}  // namespace pleat
