#include "connectivity_coder.h"

#include <gtest/gtest.h>

#include "codec/test_meshes.h"
#include "free_numbers.h"
#include "support/hostile_bytes.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

std::string Encode(const Topology& topology) {
  BinaryCoder coder = BinaryCoder::ForEncoding();
  EncodeTopology(topology, &coder);
  return coder.Finish();
}

absl::StatusOr<Topology> Decode(const std::string& bytes, const Topology& shape) {
  BinaryCoder coder = BinaryCoder::ForDecoding(bytes);
  return DecodeTopology(shape.num_vertices(), shape.num_faces(), shape.num_corners(), &coder);
}

void ExpectRoundTrip(const Topology& topology) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const Topology decoded, Decode(Encode(topology), topology));
  EXPECT_TRUE(decoded == topology);
}

TEST(ConnectivityCoderTest, QuadsInAnyOrderRoundTrip) {
  ExpectRoundTrip(MakeTorus(24, 12, 5).topology);
}

TEST(ConnectivityCoderTest, PolygonsBordersAndLonelyVerticesRoundTrip) {
  ExpectRoundTrip(*Topology::Create(9, {7, 0, 1, 2, 3, 2, 1, 8, 0, 7, 4}, {5, 3, 3}));
}

TEST(ConnectivityCoderTest, PolygonSoupRoundTrips) {
  // A fin of three faces, a doubled face, one face in both orientations, a repeated corner.
  ExpectRoundTrip(*Topology::Create(
      8, {0, 1, 2, 1, 0, 3, 0, 1, 4, 0, 1, 2, 5, 6, 7, 7, 6, 5, 3, 3, 4}, {3, 3, 3, 3, 3, 3, 3}));
}

TEST(ConnectivityCoderTest, NoFacesRoundTrip) { ExpectRoundTrip(*Topology::Create(3, {}, {})); }

TEST(ConnectivityCoderTest, OrderedMeshesAreSmall) {
  // A strip of quads in order: numbers follow each other, so a face costs a few bits.
  std::vector<int32_t> corners, sizes;
  for (int i = 0; i < 2000; ++i) {
    corners.insert(corners.end(), {2 * i, 2 * i + 1, 2 * i + 3, 2 * i + 2});
    sizes.push_back(4);
  }
  const Topology strip = *Topology::Create(4002, corners, sizes);
  EXPECT_LT(Encode(strip).size(), 1000u);
  ExpectRoundTrip(strip);
}

TEST(ConnectivityCoderTest, DamagedCodeNeverDecodesToAnInvalidMesh) {
  const TestMesh mesh = MakeTorus(8, 6, 3);
  const std::string bytes = Encode(mesh.topology);
  ForEachTruncation(bytes, [&](const std::string& damaged) {
    const absl::StatusOr<Topology> decoded = Decode(damaged, mesh.topology);
    EXPECT_TRUE(!decoded.ok() || decoded->num_corners() == mesh.topology.num_corners());
  });
  ForEachCorruption(bytes, [&](const std::string& damaged) {
    const absl::StatusOr<Topology> decoded = Decode(damaged, mesh.topology);
    EXPECT_TRUE(!decoded.ok() || decoded->num_corners() == mesh.topology.num_corners());
  });
  EXPECT_THAT(Decode("", mesh.topology), testing::Not(IsOk()));
}

TEST(FreeNumbersTest, RanksAndSelectionAgree) {
  FreeNumbers numbers(13);
  for (const int taken : {4, 0, 12, 5}) numbers.Take(taken);
  const std::vector<int> left = {1, 2, 3, 6, 7, 8, 9, 10, 11};
  ASSERT_EQ(numbers.num_free(), static_cast<int>(left.size()));
  for (size_t rank = 0; rank < left.size(); ++rank) {
    EXPECT_EQ(numbers.Select(static_cast<int>(rank)), left[rank]);
    EXPECT_EQ(numbers.Rank(left[rank]), static_cast<int>(rank));
  }
}

}  // namespace
}  // namespace pleat
