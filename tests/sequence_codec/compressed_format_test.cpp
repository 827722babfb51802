#include "compressed_format.h"

#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <limits>

#include "support/hostile_bytes.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

CompressedHeader SomeHeader() {
  CompressedHeader header;
  header.num_vertices = 30;
  header.num_faces = 20;
  header.num_corners = 70;
  header.num_frames = 600;
  header.frame_rate = {24000, 1001};
  header.num_texcoords = 33;
  header.steps = {1e-3f, 2e-4f, 3e-5f, 4e-6f};
  header.grid = {.kind = ResidualKind::kGrid, .step_m = .25, .origin_m = {1, -2, 3}, .bound_m = 0};
  header.name = "dance";
  header.segment_frames = {512, 88};
  return header;
}

// Header -> bytes -> header.
absl::StatusOr<CompressedHeader> Decode(const CompressedHeader& header) {
  return DecodeHeader(EncodeHeader(header), {});
}

// The status of SomeHeader() after `change`.
absl::Status StatusWith(const std::function<void(CompressedHeader*)>& change) {
  CompressedHeader header = SomeHeader();
  change(&header);
  return Decode(header).status();
}

TEST(CompressedFormatTest, HeadersRoundTripWithEveryKindOfResidual) {
  for (const ResidualKind kind :
       {ResidualKind::kNone, ResidualKind::kCorrection, ResidualKind::kGrid}) {
    CompressedHeader header = SomeHeader();
    header.grid.kind = kind;
    header.grid.bound_m = kind == ResidualKind::kCorrection ? .125 : 0;
    PLEAT_ASSERT_OK_AND_ASSIGN(const CompressedHeader decoded, Decode(header));
    EXPECT_EQ(decoded.num_vertices, 30u);
    EXPECT_EQ(decoded.num_faces, 20u);
    EXPECT_EQ(decoded.num_corners, 70u);
    EXPECT_EQ(decoded.num_frames, 600u);
    EXPECT_EQ(decoded.frame_rate, header.frame_rate);
    EXPECT_EQ(decoded.num_texcoords, 33u);
    EXPECT_EQ(decoded.steps.field_m, 1e-3f);
    EXPECT_EQ(decoded.steps.rest_m, 2e-4f);
    EXPECT_EQ(decoded.steps.rotation, 3e-5f);
    EXPECT_EQ(decoded.steps.translation_m, 4e-6f);
    EXPECT_EQ(decoded.grid.kind, kind);
    if (kind != ResidualKind::kNone) {
      EXPECT_EQ(decoded.grid.step_m, .25);
      EXPECT_EQ(decoded.grid.bound_m, header.grid.bound_m);
      EXPECT_EQ(decoded.grid.origin_m, Eigen::Vector3d(1, -2, 3));
    }
    EXPECT_EQ(decoded.name, "dance");
    EXPECT_EQ(decoded.segment_frames, header.segment_frames);
    EXPECT_EQ(EncodeHeader(decoded), EncodeHeader(header));
  }
}

TEST(CompressedFormatTest, LongNamesAreClippedByTheWriter) {
  CompressedHeader header = SomeHeader();
  header.name = std::string(5000, 'n');
  PLEAT_ASSERT_OK_AND_ASSIGN(const CompressedHeader decoded, Decode(header));
  EXPECT_EQ(decoded.name, std::string(4096, 'n'));
}

TEST(CompressedFormatTest, CountsOverALimitAreRefused) {
  EXPECT_THAT(DecodeHeader(EncodeHeader(SomeHeader()),
                           {.max_vertices = 30, .max_faces = 20, .max_frames = 600}),
              IsOk());
  EXPECT_THAT(DecodeHeader(EncodeHeader(SomeHeader()),
                           {.max_vertices = 29, .max_faces = 20, .max_frames = 600}),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("29")));
  EXPECT_THAT(DecodeHeader(EncodeHeader(SomeHeader()),
                           {.max_vertices = 30, .max_faces = 19, .max_frames = 600}),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("19")));
  EXPECT_THAT(DecodeHeader(EncodeHeader(SomeHeader()),
                           {.max_vertices = 30, .max_faces = 20, .max_frames = 599}),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("599")));
  CompressedHeader corners = SomeHeader();
  corners.num_corners = 161;  // eight per face are the most
  EXPECT_THAT(
      DecodeHeader(EncodeHeader(corners), {.max_vertices = 30, .max_faces = 20, .max_frames = 600}),
      HasStatus(absl::StatusCode::kResourceExhausted, testing::_));
  CompressedHeader texcoords = SomeHeader();
  texcoords.num_texcoords = 81;  // four per face
  EXPECT_THAT(DecodeHeader(EncodeHeader(texcoords),
                           {.max_vertices = 30, .max_faces = 20, .max_frames = 600}),
              HasStatus(absl::StatusCode::kResourceExhausted, testing::_));
}

TEST(CompressedFormatTest, CountsThatNoSequenceHasAreRefused) {
  for (const auto& change : std::vector<std::function<void(CompressedHeader*)>>{
           [](CompressedHeader* h) { h->num_vertices = 0; },
           [](CompressedHeader* h) { h->num_frames = 0; },
           [](CompressedHeader* h) { h->num_corners = 59; },  // fewer than three per face
           [](CompressedHeader* h) { h->frame_rate.numerator = 0; },
           [](CompressedHeader* h) { h->frame_rate.denominator = 0; },
           [](CompressedHeader* h) { h->frame_rate.denominator = -1; }}) {
    EXPECT_THAT(StatusWith(change), HasStatus(absl::StatusCode::kInvalidArgument, testing::_));
  }
}

TEST(CompressedFormatTest, StepsAndGridsThatAreNoLengthsAreRefused) {
  for (const float step : {0.f, -1.f, 2e12f, std::numeric_limits<float>::quiet_NaN()}) {
    for (const auto member : {&MotionSteps::field_m, &MotionSteps::rest_m, &MotionSteps::rotation,
                              &MotionSteps::translation_m}) {
      EXPECT_THAT(
          StatusWith([&](CompressedHeader* h) { h->steps.*member = step; }),
          HasStatus(absl::StatusCode::kInvalidArgument, "a quantization step is out of range"));
    }
    const auto refused =
        HasStatus(absl::StatusCode::kInvalidArgument, "the residual grid is out of range");
    EXPECT_THAT(StatusWith([&](CompressedHeader* h) { h->grid.step_m = double{step}; }), refused);
    if (step == 0) continue;
    EXPECT_THAT(StatusWith([&](CompressedHeader* h) { h->grid.bound_m = double{step}; }), refused);
    if (step == -1) continue;
    EXPECT_THAT(StatusWith([&](CompressedHeader* h) { h->grid.origin_m[1] = double{step}; }),
                refused);
  }
}

TEST(CompressedFormatTest, SegmentsMustHoldTheFramesOfTheHeader) {
  EXPECT_THAT(StatusWith([](CompressedHeader* h) {
                h->segment_frames = {512, 87};
              }),
              HasStatus(absl::StatusCode::kInvalidArgument,
                        "the segments have 599 frames, the header says 600"));
  EXPECT_THAT(StatusWith([](CompressedHeader* h) {
                h->segment_frames = {513, 87};
              }),
              HasStatus(absl::StatusCode::kInvalidArgument, "segment 0 has 513 frames"));
  EXPECT_THAT(StatusWith([](CompressedHeader* h) {
                h->segment_frames = {512, 88, 0};
              }),
              HasStatus(absl::StatusCode::kInvalidArgument, "segment 2 has 0 frames"));
}

TEST(CompressedFormatTest, AnOriginIsWrittenWhereThereIsOne) {
  CompressedHeader header = SomeHeader();
  EXPECT_TRUE(DecodeHeader(EncodeHeader(header), {})->origin_m.isZero(0));
  const size_t size = EncodeHeader(header).size();
  header.origin_m = Eigen::Vector3d(1e7, -2.5, 0);
  std::string bytes = EncodeHeader(header);
  EXPECT_EQ(bytes.size(), size + 24);
  EXPECT_EQ(DecodeHeader(bytes, {})->origin_m, header.origin_m);
  bytes.back() = '\x7f';  // of the last coordinate: beyond what float32 holds
  EXPECT_THAT(DecodeHeader(bytes, {}),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("origin")));
}

TEST(CompressedFormatTest, UnknownFlagsAndKindsAreNamed) {
  std::string bytes = EncodeHeader(SomeHeader());
  bytes[32] = 8;  // behind eight counts
  EXPECT_THAT(DecodeHeader(bytes, {}),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("flags")));
  bytes[32] = 3;
  bytes[33] = 3;
  EXPECT_THAT(DecodeHeader(bytes, {}),
              HasStatus(absl::StatusCode::kInvalidArgument, "residuals of the unknown kind 3"));
}

TEST(CompressedFormatTest, EveryCutAndEveryTailOfAHeaderIsRefused) {
  const std::string bytes = EncodeHeader(SomeHeader());
  ForEachTruncation(bytes, [](const std::string& cut) {
    EXPECT_FALSE(DecodeHeader(cut, {}).ok()) << cut.size();
  });
  EXPECT_THAT(DecodeHeader(bytes + "x", {}),
              HasStatus(absl::StatusCode::kDataLoss, "the header is too long"));
}

void WriteBeginning(uint32_t version, ByteWriter* writer) {
  writer->WriteRaw("PLEATCMP");
  writer->Write(version);
}

std::string TwoSections() {
  ByteWriter writer;
  WriteBeginning(2, &writer);
  WriteSection(SectionKind::kRest, "rest", &writer);
  WriteSection(SectionKind::kEnd, "", &writer);
  return writer.Release();
}

TEST(CompressedFormatTest, SectionsComeInTheirOrder) {
  const std::string bytes = TwoSections();
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::vector<Section> sections, ReadSections(bytes));
  ASSERT_EQ(sections.size(), 2u);
  EXPECT_EQ(sections[0].kind, SectionKind::kRest);
  EXPECT_EQ(sections[0].payload, "rest");
  EXPECT_EQ(sections[1].kind, SectionKind::kEnd);
}

TEST(CompressedFormatTest, DamagedSectionsAreNamedByTheirNumber) {
  std::string payload = TwoSections();
  payload[12 + 9] ^= 1;
  EXPECT_THAT(
      ReadSections(payload),
      HasStatus(absl::StatusCode::kDataLoss, "section 0 is damaged: its checksum does not agree"));
  std::string kind = TwoSections();
  kind[12 + 9 + 4] = 9;
  EXPECT_THAT(ReadSections(kind),
              HasStatus(absl::StatusCode::kDataLoss, "section 1 is of no known kind"));
  EXPECT_THAT(ReadSections(TwoSections() + "abc"),
              HasStatus(absl::StatusCode::kDataLoss, "3 bytes too many at the end"));
  ForEachTruncation(TwoSections(),
                    [](const std::string& cut) { EXPECT_FALSE(ReadSections(cut).ok()); });
}

TEST(CompressedFormatTest, ListsOfFacesExistSinceVersionTwo) {
  ByteWriter writer;
  WriteBeginning(2, &writer);
  WriteSection(SectionKind::kFaceList, "faces", &writer);
  WriteSection(SectionKind::kEnd, "", &writer);
  std::string bytes = writer.Release();
  EXPECT_THAT(ReadSections(bytes), IsOk());
  bytes[8] = 1;
  EXPECT_THAT(ReadSections(bytes), HasStatus(absl::StatusCode::kDataLoss, HasSubstr("section 0")));
  bytes[8] = 3;
  EXPECT_THAT(ReadSections(bytes),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("version 3")));
}

TEST(CompressedFormatTest, FrameChecksumsAreThoseOfTheirBytes) {
  const std::vector<Eigen::Matrix3Xf> frames = {Eigen::Matrix3Xf::Random(3, 5),
                                                Eigen::Matrix3Xf::Random(3, 5)};
  std::string bytes;
  for (const Eigen::Matrix3Xf& frame : frames) {
    bytes.append(reinterpret_cast<const char*>(frame.data()), 60);
  }
  EXPECT_EQ(FramesChecksum(frames), ShortChecksum(bytes));
  // Published vector of SHA-256 (FIPS 180-2, "abc"): ba7816bf..., read as little-endian.
  EXPECT_EQ(ShortChecksum("abc"), 0xbf1678bau);
}

}  // namespace
}  // namespace pleat
