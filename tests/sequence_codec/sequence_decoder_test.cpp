#include "pleat/sequence_codec/sequence_decoder.h"

#include <gtest/gtest.h>

#include "pleat/base/bytes.h"
#include "pleat/base/file.h"
#include "pleat/sequence_codec/compress_sequence.h"
#include "sequence_codec/compressed_clip.h"
#include "support/hostile_bytes.h"
#include "support/source_folder.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using testing::HasSubstr;

absl::Status DecodeAll(const std::string& bytes, const MeshLimits& limits = {}) {
  absl::StatusOr<SequenceDecoder> decoder = SequenceDecoder::Open(bytes, limits);
  if (!decoder.ok()) return decoder.status();
  return decoder->DecodeAll().status();
}

std::string SmallFile() {
  return CompressSequence(MakeWavingTorus(6, 5, 18), {.max_error_mm = 2}, nullptr).value();
}

TEST(SequenceDecoderTest, AnyRangeGivesTheFramesOfTheWhole) {
  const MeshSequence sequence = MakeWavingTorus(6, 5, 530);
  SequenceDecoder decoder =
      SequenceDecoder::Open(CompressSequence(sequence, {.max_error_mm = 2}, nullptr).value())
          .value();
  const MeshSequence all = decoder.DecodeAll().value();
  // Within a group, across groups, across the segments, backwards.
  for (const auto& [begin, end] : std::vector<std::pair<int, int>>{
           {0, 1}, {528, 530}, {5, 40}, {260, 270}, {17, 18}, {0, 530}}) {
    int next = begin;
    ASSERT_THAT(decoder.Decode(begin, end,
                               [&](int t, const Eigen::Matrix3Xf& positions) {
                                 EXPECT_EQ(t, next++);
                                 EXPECT_EQ(positions, all.frame(t));
                                 return absl::OkStatus();
                               }),
                IsOk());
    EXPECT_EQ(next, end);
  }
  for (const int t : {529, 0, 1, 15, 16, 511, 512, 300, 300, 17}) {
    EXPECT_EQ(**decoder.DecodeFrame(t), all.frame(t)) << t;
  }
  EXPECT_THAT(decoder.DecodeFrame(530), HasStatus(absl::StatusCode::kInvalidArgument, testing::_));
  EXPECT_THAT(decoder.DecodeFrame(-1), HasStatus(absl::StatusCode::kInvalidArgument, testing::_));
}

TEST(SequenceDecoderTest, RangesOutsideAndErrorsOfTheSinkAreTold) {
  SequenceDecoder decoder = SequenceDecoder::Open(SmallFile()).value();
  const auto ignore = [](int, const Eigen::Matrix3Xf&) { return absl::OkStatus(); };
  for (const auto& [begin, end] : {std::pair(-1, 3), {3, 3}, {4, 2}, {0, 19}}) {
    EXPECT_THAT(decoder.Decode(begin, end, ignore),
                HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("which has 18")));
  }
  EXPECT_THAT(decoder.Decode(0, 18,
                             [](int, const Eigen::Matrix3Xf&) {
                               return absl::ResourceExhaustedError("disk full");
                             }),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("disk full")));
}

TEST(SequenceDecoderTest, SaysWhatWasPromised) {
  EXPECT_NEAR(SequenceDecoder::Open(SmallFile())->promise().max_error_mm, 2, 1e-3);
}

TEST(SequenceDecoderTest, EveryTruncationAndEveryChangedByteIsSeen) {
  const std::string bytes = SmallFile();
  ASSERT_THAT(DecodeAll(bytes), IsOk());
  ForEachTruncation(bytes,
                    [](const std::string& cut) { EXPECT_FALSE(SequenceDecoder::Open(cut).ok()); });
  ForEachCorruption(
      bytes, [](const std::string& damaged) { EXPECT_FALSE(SequenceDecoder::Open(damaged).ok()); });
}

// Behind the checksums nothing may crash, hang or take much memory; wrong frames are refused.
TEST(SequenceDecoderTest, DamageWithRightChecksumsIsHarmless) {
  const std::string bytes = SmallFile();
  MeshLimits limits;
  limits.max_vertices = 10'000;
  limits.max_faces = 10'000;
  limits.max_frames = 1000;
  limits.max_field_bytes = 50'000'000;
  int num_accepted = 0;
  for (size_t i = 12; i < bytes.size(); ++i) {
    for (const int change : {0x01, 0x80, 0xff}) {
      std::string damaged = bytes;
      damaged[i] = static_cast<char>(damaged[i] ^ change);
      num_accepted += DecodeAll(ResealSections(damaged), limits).ok();
    }
  }
  // Names, the frame rate and some bits behind the last decision of a code do not matter.
  EXPECT_LT(num_accepted, 3 * static_cast<int>(bytes.size()) / 5);
}

TEST(SequenceDecoderTest, HugeCountsAreRefusedBeforeMemoryIsTaken) {
  const std::string bytes = SmallFile();
  const size_t header = 12 + 9;
  for (const size_t field : {0, 1, 2, 3, 6, 7}) {  // V, F, C, T, X, M
    for (const uint32_t count : {0x7fffffffu, 0xffffffffu, 3'900'000u}) {
      std::string damaged = bytes;
      std::memcpy(damaged.data() + header + 4 * field, &count, 4);
      EXPECT_FALSE(SequenceDecoder::Open(ResealSections(damaged)).ok()) << field;
    }
  }
}

TEST(SequenceDecoderTest, OtherFilesAndVersionsAreNamed) {
  EXPECT_THAT(DecodeAll("POINTCACHE2"),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr(".plt")));
  std::string other = SmallFile();
  other[8] = 9;
  EXPECT_THAT(DecodeAll(other),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("version 9")));
  EXPECT_THAT(DecodeAll(SmallFile() + "x"),
              HasStatus(absl::StatusCode::kDataLoss, HasSubstr("too many")));
}

TEST(SequenceDecoderTest, LimitsHold) {
  MeshLimits limits;
  limits.max_frames = 17;
  EXPECT_THAT(DecodeAll(SmallFile(), limits),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("17 frames")));
  limits = {};
  limits.max_field_bytes = 100;
  EXPECT_THAT(DecodeAll(SmallFile(), limits),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("100 bytes")));
}

// A file of the first release: it must decode to the same positions for ever, on every machine.
TEST(SequenceDecoderTest, TheGoldenFileStaysReadable) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::string bytes,
                             ReadFile(InSourceFolder("tests/golden/compressed_v1.plt")));
  PLEAT_ASSERT_OK_AND_ASSIGN(SequenceDecoder decoder, SequenceDecoder::Open(bytes));
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence decoded, decoder.DecodeAll());
  EXPECT_EQ(decoded.name(), "waving torus");
  EXPECT_EQ(decoded.num_frames(), 18);
  EXPECT_TRUE(decoded.topology() == MakeTorus(6, 5, 5).topology);
}

TEST(SequenceDecoderTest, TheGoldenFileWithAListOfFacesStaysReadable) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::string bytes,
                             ReadFile(InSourceFolder("tests/golden/compressed_v2.plt")));
  PLEAT_ASSERT_OK_AND_ASSIGN(SequenceDecoder decoder, SequenceDecoder::Open(bytes));
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence decoded, decoder.DecodeAll());
  EXPECT_EQ(decoded.num_frames(), 3);
  EXPECT_TRUE(decoded.topology() == QuadsAsModeled(4, 5));
  EXPECT_NEAR(decoded.frame(2)(1, 7), 2, 1e-3);
}

}  // namespace
}  // namespace pleat
