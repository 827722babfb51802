#include "draco_guard.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::HasSubstr;

absl::StatusOr<uint64_t> Varint(const std::string& bytes) {
  ByteReader reader(bytes);
  return ReadDracoVarint(&reader, "faces");
}

TEST(DracoGuardTest, VarintsAreReadSevenBitsAtATimeLowestFirst) {
  EXPECT_EQ(Varint(std::string("\x00", 1)).value(), 0u);
  EXPECT_EQ(Varint("\x7f").value(), 127u);
  EXPECT_EQ(Varint("\x80\x01").value(), 128u);
  EXPECT_EQ(Varint("\xac\x02").value(), 300u);
  EXPECT_EQ(Varint("\xff\xff\xff\xff\x0f").value(), 0xffffffffu);
}

TEST(DracoGuardTest, VarintsThatDoNotEndAreNamed) {
  EXPECT_THAT(Varint("\xff\xff\xff\xff\xff\x01"),
              HasStatus(absl::StatusCode::kDataLoss, "malformed Draco frame: faces is too long"));
  EXPECT_THAT(Varint("\x80"), HasStatus(absl::StatusCode::kDataLoss, HasSubstr("faces")));
  EXPECT_THAT(Varint(""), HasStatus(absl::StatusCode::kDataLoss, HasSubstr("faces")));
}

TEST(DracoGuardTest, MeshesAndCloudsHaveVersionsOfTheirOwn) {
  for (const auto& [type, minor] : {std::pair(1, 2), std::pair(0, 3)}) {
    for (int other = 0; other < 5; ++other) {
      std::string bytes = "DRACO";
      for (const int byte : {2, other, type, 0, 0, 0x80}) bytes += static_cast<char>(byte);
      ByteReader reader(bytes);
      const absl::StatusOr<DracoHeader> header = ReadDracoHeader(&reader);
      ASSERT_EQ(header.ok(), other == minor) << type << " " << other;
      if (!header.ok()) continue;
      EXPECT_EQ(header->type, type);
      EXPECT_TRUE(header->has_metadata());
      EXPECT_EQ(reader.remaining(), 0u);
    }
  }
}

TEST(DracoGuardTest, CountsStandInAnotherOrderInEachMethod) {
  const std::string sequential = "\x05\x03";  // faces, points
  ByteReader reader(sequential);
  PLEAT_ASSERT_OK_AND_ASSIGN(const DracoMeshCounts counts,
                             ReadDracoMeshCounts(&reader, kDracoSequential));
  EXPECT_EQ(counts.num_faces, 5u);
  EXPECT_EQ(counts.num_points, 3u);
  const std::string edgebreaker("\x00\x03\x05\x01", 4);  // traversal, vertices, faces, data
  ByteReader other(edgebreaker);
  PLEAT_ASSERT_OK_AND_ASSIGN(const DracoMeshCounts others,
                             ReadDracoMeshCounts(&other, kDracoEdgebreaker));
  EXPECT_EQ(others.num_faces, 5u);
  EXPECT_EQ(others.num_points, 3u);
  EXPECT_EQ(others.num_attribute_data, 1);
  ByteReader unknown(sequential);
  EXPECT_THAT(ReadDracoMeshCounts(&unknown, 2),
              HasStatus(absl::StatusCode::kDataLoss, HasSubstr("unknown mesh encoding method")));
  ByteReader traversal(sequential);
  EXPECT_THAT(ReadDracoMeshCounts(&traversal, kDracoEdgebreaker),
              HasStatus(absl::StatusCode::kDataLoss, HasSubstr("unknown traversal type")));
}

// A decoder that does what the test says where Draco would decode attribute values.
struct FakeGeometry {};
template <typename Error>
class ThrowingDecoder {
 public:
  virtual ~ThrowingDecoder() = default;
  draco::Status Decode(const draco::DecoderOptions&, draco::DecoderBuffer*, FakeGeometry*) {
    return DecodeAllAttributes() ? draco::OkStatus()
                                 : draco::Status(draco::Status::DRACO_ERROR, "attributes");
  }

 protected:
  const draco::PointCloud* point_cloud() const { return &cloud_; }
  virtual bool DecodeAllAttributes() { throw Error(); }

 private:
  draco::PointCloud cloud_;
};

struct LengthError : std::length_error {
  LengthError() : std::length_error("vector::reserve") {}
};

TEST(DracoGuardTest, ExceptionsBecomeStatuses) {
  FakeGeometry geometry;
  const auto accept = [](const draco::PointCloud&) { return true; };
  EXPECT_THAT(RunDracoDecoder<ThrowingDecoder<std::bad_alloc>>("", accept, &geometry),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("more memory")));
  EXPECT_THAT(RunDracoDecoder<ThrowingDecoder<LengthError>>("", accept, &geometry),
              HasStatus(absl::StatusCode::kDataLoss, HasSubstr("more than memory can hold")));
}

TEST(DracoGuardTest, ARefusedAttributeIsNeverDecoded) {
  FakeGeometry geometry;
  EXPECT_THAT(RunDracoDecoder<ThrowingDecoder<std::bad_alloc>>(
                  "", [](const draco::PointCloud&) { return false; }, &geometry),
              HasStatus(absl::StatusCode::kDataLoss, "malformed Draco frame: attributes"));
}

}  // namespace
}  // namespace pleat
