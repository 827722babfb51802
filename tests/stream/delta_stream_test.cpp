// Streams of key frames and differences: FrameEncoder and FrameDecoder with kDracoDelta.
#include <gtest/gtest.h>

#include "draco/compression/decode.h"
#include "pleat/stream/frame_decoder.h"
#include "pleat/stream/frame_encoder.h"
#include "support/hostile_bytes.h"
#include "support/status_matchers.h"
#include "support/test_meshes.h"

namespace pleat {
namespace {

using testing::HasSubstr;

constexpr FrameEncoderOptions kDelta{.encoding = FrameEncoding::kDracoDelta};

struct Frame {
  std::string bytes;
  FrameMark mark;
};

Frame Next(FrameEncoder* encoder, const Eigen::Matrix3Xf& positions) {
  std::string bytes = encoder->Encode(positions).value();
  return {std::move(bytes), encoder->mark()};
}

double LargestError(const Eigen::Matrix3Xf& a, const Eigen::Matrix3Xf& b) {
  return (a - b).cast<double>().colwise().norm().maxCoeff();
}

TEST(DeltaStreamTest, LosslessOnTheGridAndWithoutDrift) {
  const TestMesh torus = MakeTorus(24, 12, 3);
  for (const TestMesh& mesh :
       {torus, WithExtra(torus, 3, {}), WithExtra(torus, 1, {{288, 288, 9}, {0, 1, 288}})}) {
    FrameEncoder encoder = FrameEncoder::Create(mesh.topology, mesh.positions, kDelta).value();
    FrameDecoder decoder = FrameDecoder::Create(encoder.header()).value();
    const double half_diagonal = std::sqrt(.75) * encoder.header().box.step_m();
    for (int t = 0; t < 60; ++t) {
      const Eigen::Matrix3Xf positions = Bend(mesh.positions, t);
      const Frame frame = Next(&encoder, positions);
      EXPECT_EQ(frame.mark.keyframe, t == 0);
      Eigen::Matrix3Xf decoded;
      ASSERT_THAT(decoder.Decode(frame.bytes, frame.mark, &decoded), IsOk());
      EXPECT_LE(LargestError(decoded, positions), half_diagonal * 1.001 + 1e-6);
    }
  }
}

TEST(DeltaStreamTest, DifferencesAreMuchSmallerThanKeyFrames) {
  const TestMesh mesh = MakeTorus(80, 40, 3);
  FrameEncoder encoder = FrameEncoder::Create(mesh.topology, mesh.positions, kDelta).value();
  const size_t key = Next(&encoder, Bend(mesh.positions, 0)).bytes.size();
  const size_t difference = Next(&encoder, Bend(mesh.positions, 1)).bytes.size();
  EXPECT_LT(4 * difference, key);
}

TEST(DeltaStreamTest, EveryPayloadIsDraco) {
  const TestMesh mesh = MakeTorus(24, 12, 3);
  FrameEncoder encoder = FrameEncoder::Create(mesh.topology, mesh.positions, kDelta).value();
  for (int t = 0; t < 3; ++t) {
    const Frame frame = Next(&encoder, Bend(mesh.positions, t));
    draco::DecoderBuffer buffer;
    buffer.Init(frame.bytes.data(), frame.bytes.size());
    draco::Decoder decoder;
    const auto cloud = decoder.DecodePointCloudFromBuffer(&buffer);
    ASSERT_TRUE(cloud.ok());
    EXPECT_EQ(cloud.value()->num_points(), 288u);
    EXPECT_EQ(cloud.value()->num_attributes(), t == 0 ? 1 : 3);
    EXPECT_EQ(buffer.remaining_size(), 0);
  }
}

TEST(DeltaStreamTest, AKeyFrameIsSentWhenAskedForAndWhenCheaper) {
  const TestMesh mesh = MakeTorus(24, 12, 3);
  FrameEncoder encoder = FrameEncoder::Create(mesh.topology, mesh.positions, kDelta).value();
  EXPECT_TRUE(Next(&encoder, mesh.positions).mark.keyframe);
  EXPECT_FALSE(Next(&encoder, Bend(mesh.positions, 1)).mark.keyframe);
  encoder.RequestKeyframe();
  EXPECT_TRUE(Next(&encoder, Bend(mesh.positions, 2)).mark.keyframe);
  // From noise back to the smooth shape: the difference is noise again.
  const Eigen::Matrix3Xf noise = Eigen::Matrix3Xf::Random(3, mesh.positions.cols());
  Next(&encoder, noise);
  EXPECT_TRUE(Next(&encoder, mesh.positions).mark.keyframe);
}

TEST(DeltaStreamTest, ALostFrameIsNoticedAndAKeyFrameHeals) {
  const TestMesh mesh = MakeTorus(24, 12, 3);
  FrameEncoder encoder = FrameEncoder::Create(mesh.topology, mesh.positions, kDelta).value();
  FrameDecoder decoder = FrameDecoder::Create(encoder.header()).value();
  Eigen::Matrix3Xf decoded;
  const Frame first = Next(&encoder, mesh.positions);
  ASSERT_THAT(decoder.Decode(first.bytes, first.mark, &decoded), IsOk());
  Next(&encoder, Bend(mesh.positions, 1));  // lost
  const Frame third = Next(&encoder, Bend(mesh.positions, 2));
  EXPECT_THAT(decoder.Decode(third.bytes, third.mark, &decoded),
              HasStatus(absl::StatusCode::kDataLoss, HasSubstr("checksum")));
  const Frame fourth = Next(&encoder, Bend(mesh.positions, 3));
  EXPECT_THAT(decoder.Decode(fourth.bytes, fourth.mark, &decoded),
              HasStatus(absl::StatusCode::kFailedPrecondition, HasSubstr("key frame")));
  encoder.RequestKeyframe();
  const Frame key = Next(&encoder, Bend(mesh.positions, 4));
  ASSERT_THAT(decoder.Decode(key.bytes, key.mark, &decoded), IsOk());
  const Frame next = Next(&encoder, Bend(mesh.positions, 5));
  ASSERT_THAT(decoder.Decode(next.bytes, next.mark, &decoded), IsOk());
  EXPECT_LE(LargestError(decoded, Bend(mesh.positions, 5)), encoder.header().box.step_m());
}

TEST(DeltaStreamTest, TheGridFollowsABoundInMillimeters) {
  const TestMesh mesh = MakeTorus(24, 12, 3);
  for (const double bound_mm : {0.05, 0.4, 3.0}) {
    FrameEncoderOptions options = kDelta;
    options.max_error_mm = bound_mm;
    FrameEncoder encoder = FrameEncoder::Create(mesh.topology, mesh.positions, options).value();
    FrameDecoder decoder = FrameDecoder::Create(encoder.header()).value();
    double worst = 0;
    for (int t = 0; t < 5; ++t) {
      const Frame frame = Next(&encoder, Bend(mesh.positions, t));
      Eigen::Matrix3Xf decoded;
      ASSERT_THAT(decoder.Decode(frame.bytes, frame.mark, &decoded), IsOk());
      worst = std::max(worst, 1e3 * LargestError(decoded, Bend(mesh.positions, t)));
    }
    EXPECT_LE(worst, bound_mm);
    EXPECT_GE(worst, .7 * bound_mm);  // no finer than it must be
  }
  FrameEncoderOptions too_fine = kDelta;
  too_fine.max_error_mm = 1e-3;
  EXPECT_THAT(FrameEncoder::Create(mesh.topology, mesh.positions, too_fine),
              HasStatus(absl::StatusCode::kInvalidArgument, testing::_));
}

TEST(DeltaStreamTest, DamagedDifferencesNeverCrash) {
  const TestMesh mesh = MakeTorus(8, 6, 3);
  FrameEncoder encoder = FrameEncoder::Create(mesh.topology, mesh.positions, kDelta).value();
  const FrameDecoder fresh = FrameDecoder::Create(encoder.header()).value();
  const Frame key = Next(&encoder, mesh.positions);
  const Frame difference = Next(&encoder, Bend(mesh.positions, 1));
  const auto decode = [&](const std::string& bytes) {
    FrameDecoder decoder = fresh;
    Eigen::Matrix3Xf decoded;
    ASSERT_THAT(decoder.Decode(key.bytes, key.mark, &decoded), IsOk());
    decoder.Decode(bytes, difference.mark, &decoded).IgnoreError();
  };
  ForEachTruncation(difference.bytes, decode);
  ForEachCorruption(difference.bytes, decode);
}

}  // namespace
}  // namespace pleat
