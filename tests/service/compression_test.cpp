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

}  // namespace
}  // namespace pleat
