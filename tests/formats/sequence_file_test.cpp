#include "pleat/formats/sequence_file.h"

#include "pleat/base/file.h"
#include "support/hostile_bytes.h"
#include "support/mesh_shapes.h"
#include "support/source_folder.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using testing::HasSubstr;

// Two frames of a small polygon mesh with everything an appearance can have.
MeshSequence MakeSequence(FrameRate frame_rate = {30000, 1001}) {
  MeshSequenceOptions options;
  options.name = "tiny";
  options.frame_rate = frame_rate;
  options.appearance = {
      {{0, 0}, {1, 0.5f}}, {0, 1, -1, 0, 1, 1, 0}, {"skin", ""}, {1, -1}, "a.mtl"};
  Eigen::Matrix3Xf frame(3, 4);
  frame << 0, 1, 1, 0, 0, 0, 1, 1, 0, 0, 0, 0.25f;
  return *MeshSequence::Create(*Topology::Create(4, {0, 1, 2, 3, 0, 2, 3}, {4, 3}),
                               {frame, frame * 2}, options);
}

TEST(SequenceFileTest, EverythingRoundTrips) {
  const MeshSequence sequence = MakeSequence();
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence read, DecodeSequence(EncodeSequence(sequence)));
  EXPECT_EQ(read.name(), "tiny");
  EXPECT_EQ(read.frame_rate(), (FrameRate{30000, 1001}));
  EXPECT_TRUE(read.topology() == sequence.topology());
  EXPECT_EQ(read.frame(1), sequence.frame(1));
  EXPECT_EQ(read.appearance().texcoords, sequence.appearance().texcoords);
  EXPECT_EQ(read.appearance().corner_texcoords, sequence.appearance().corner_texcoords);
  EXPECT_EQ(read.appearance().material_names, sequence.appearance().material_names);
  EXPECT_EQ(read.appearance().face_materials, sequence.appearance().face_materials);
  EXPECT_EQ(read.appearance().material_library, "a.mtl");
}

TEST(SequenceFileTest, LayoutIsTheDocumentedOne) {
  const MeshShape box = MakeBox({1, 1, 1});
  const MeshSequence sequence =
      *MeshSequence::Create(box.topology, {box.positions.cast<float>()}, {.name = "box"});
  const std::string bytes = EncodeSequence(sequence);
  EXPECT_EQ(bytes.substr(0, 8), "PLEATSEQ");
  const auto word = [&](size_t index) {
    uint32_t value;
    std::memcpy(&value, bytes.data() + 4 * index, 4);
    return value;
  };
  // version, V, F, C, T, rate, texture coordinates, materials, flags
  const uint32_t expected[] = {1, 8, 6, 24, 1, 30, 1, 0, 0, 0};
  for (size_t i = 0; i < 10; ++i) EXPECT_EQ(word(2 + i), expected[i]) << i;
  EXPECT_EQ(bytes.size(), 48u + (4 + 3) + 4 + 6 * 4 + 24 * 4 + 8 * 12 + 32);
}

TEST(SequenceFileTest, SameSequenceSameBytesAndId) {
  EXPECT_EQ(EncodeSequence(MakeSequence()), EncodeSequence(MakeSequence()));
  const std::string bytes = EncodeSequence(MakeSequence());
  EXPECT_EQ(SequenceId(bytes).size(), 64u);
  EXPECT_NE(SequenceId(bytes), SequenceId(EncodeSequence(MakeSequence({25, 1}))));
}

TEST(SequenceFileTest, ForeignVersionsAndCorruptionAreTold) {
  std::string bytes = EncodeSequence(MakeSequence());
  EXPECT_THAT(DecodeSequence(""),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("empty")));
  EXPECT_THAT(
      DecodeSequence("v 0 0 0\nv 1 1 1"),
      HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("not a Pleat sequence file")));
  std::string other = bytes;
  other[8] = 2;
  EXPECT_THAT(DecodeSequence(Reseal(other)),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("version 2")));
  other = bytes;
  other[60] ^= 1;
  EXPECT_THAT(DecodeSequence(other), HasStatus(absl::StatusCode::kDataLoss, HasSubstr("checksum")));
  EXPECT_THAT(DecodeSequence(bytes.substr(0, 100)),
              HasStatus(absl::StatusCode::kDataLoss, HasSubstr("cut off")));
}

TEST(SequenceFileTest, LimitsHoldBeforeAnythingIsAllocated) {
  std::string bytes = EncodeSequence(MakeSequence());
  const auto with = [&](size_t at, uint32_t value) {
    std::string changed = bytes;
    std::memcpy(changed.data() + at, &value, 4);
    return DecodeSequence(Reseal(changed));
  };
  EXPECT_THAT(with(12, 0xffffffff),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("limit")));
  EXPECT_THAT(with(16, 7'000'000), HasStatus(absl::StatusCode::kDataLoss, HasSubstr("face sizes")));
  EXPECT_THAT(with(20, 0xffffffff),
              HasStatus(absl::StatusCode::kDataLoss, HasSubstr("corner vertices")));
  EXPECT_THAT(with(24, 90'000), HasStatus(absl::StatusCode::kDataLoss, HasSubstr("positions")));
  EXPECT_THAT(with(36, 0xffffffff), HasStatus(absl::StatusCode::kDataLoss, HasSubstr("texture")));
  EXPECT_THAT(with(40, 0xffffffff), HasStatus(absl::StatusCode::kDataLoss, HasSubstr("material")));
  EXPECT_THAT(with(44, 4), HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("flags")));
  EXPECT_THAT(DecodeSequence(bytes, {.max_frames = 1}),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("1 frames")));
}

TEST(SequenceFileTest, EveryTruncationFailsAlsoWithAValidChecksum) {
  const std::string bytes = EncodeSequence(MakeSequence());
  ForEachTruncation(bytes, [](const std::string& damaged) {
    EXPECT_FALSE(DecodeSequence(damaged).ok());
    EXPECT_FALSE(DecodeSequence(Reseal(damaged)).ok()) << damaged.size();
  });
}

TEST(SequenceFileTest, EveryCorruptionFailsOrIsAValidSequence) {
  const std::string bytes = EncodeSequence(MakeSequence());
  int num_valid = 0;
  ForEachCorruption(bytes, [&](const std::string& damaged) {
    EXPECT_FALSE(DecodeSequence(damaged).ok());
    const absl::StatusOr<MeshSequence> sequence = DecodeSequence(Reseal(damaged));
    if (!sequence.ok()) return;
    ++num_valid;
    // Canonical: what reads, writes back to the same bytes.
    EXPECT_EQ(EncodeSequence(*sequence), Reseal(damaged));
  });
  EXPECT_GT(num_valid, 100);
}

// tests/golden/sequence_v1.pseq was written from docs/formats/sequence_file.md by other code.
TEST(SequenceFileTest, GoldenFileOfVersion1StaysReadable) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::string bytes,
                             ReadFile(InSourceFolder("tests/golden/sequence_v1.pseq")));
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence sequence, DecodeSequence(bytes));
  EXPECT_EQ(sequence.name(), "tiny");
  EXPECT_EQ(sequence.num_frames(), 2);
  EXPECT_EQ(sequence.frame(1).col(3), Eigen::Vector3f(0, 2, 0.5f));
  EXPECT_THAT(sequence.topology().face(1), testing::ElementsAre(0, 2, 3));
  EXPECT_THAT(sequence.appearance().material_names, testing::ElementsAre("skin", "cloth"));
  EXPECT_EQ(EncodeSequence(sequence), bytes);
}

TEST(SequenceFileTest, FilesRoundTripAndErrorsNameThem) {
  const TemporaryFolder folder;
  ASSERT_THAT(WriteSequenceFile(folder.File("a.pseq"), MakeSequence()), IsOk());
  EXPECT_THAT(ReadSequenceFile(folder.File("a.pseq")), IsOk());
  EXPECT_THAT(ReadSequenceFile(folder.File("b.pseq")),
              HasStatus(absl::StatusCode::kNotFound, HasSubstr("b.pseq")));
}

}  // namespace
}  // namespace pleat
