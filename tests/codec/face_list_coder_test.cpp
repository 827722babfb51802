#include "face_list_coder.h"

#include <gtest/gtest.h>

#include "codec/test_meshes.h"
#include "connectivity_coder.h"
#include "free_numbers.h"
#include "support/hostile_bytes.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

std::string Encode(const Topology& topology) {
  BinaryCoder coder = BinaryCoder::ForEncoding();
  EncodeFaceList(topology, &coder);
  return coder.Finish();
}

absl::StatusOr<Topology> Decode(const std::string& bytes, const Topology& shape) {
  BinaryCoder coder = BinaryCoder::ForDecoding(bytes);
  return DecodeFaceList(shape.num_vertices(), shape.num_faces(), shape.num_corners(), &coder);
}

void ExpectRoundTrip(const Topology& topology) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const Topology decoded, Decode(Encode(topology), topology));
  EXPECT_TRUE(decoded == topology);
}

TEST(FaceListCoderTest, FacesInAnyOrderRoundTrip) {
  ExpectRoundTrip(MakeTorus(24, 12, 5).topology);
  ExpectRoundTrip(QuadsAsModelled(7, 9));
}

TEST(FaceListCoderTest, PolygonsBordersAndLonelyVerticesRoundTrip) {
  ExpectRoundTrip(*Topology::Create(9, {7, 0, 1, 2, 3, 2, 1, 8, 0, 7, 4}, {5, 3, 3}));
}

TEST(FaceListCoderTest, PolygonSoupRoundTrips) {
  // A fin of three faces, a doubled face, one face in both orientations, a repeated corner.
  ExpectRoundTrip(*Topology::Create(
      8, {0, 1, 2, 1, 0, 3, 0, 1, 4, 0, 1, 2, 5, 6, 7, 7, 6, 5, 3, 3, 4}, {3, 3, 3, 3, 3, 3, 3}));
}

TEST(FaceListCoderTest, NoFacesRoundTrip) { ExpectRoundTrip(*Topology::Create(3, {}, {})); }

TEST(FaceListCoderTest, MeshesAsModelledAreMuchSmallerThanByTheirSurface) {
  const Topology mesh = QuadsAsModelled(40, 50);
  BinaryCoder coder = BinaryCoder::ForEncoding();
  EncodeTopology(mesh, &coder);
  const size_t by_surface = coder.Finish().size();
  EXPECT_LT(8.0 * static_cast<double>(Encode(mesh).size()) / mesh.num_faces(), .5);  // bits
  EXPECT_LT(4 * Encode(mesh).size(), by_surface);
  ExpectRoundTrip(mesh);
}

// The same triangle twenty thousand times: every edge stays open.
TEST(FaceListCoderTest, FacesThatTakeTooLongAreRefused) {
  constexpr int kFaces = 20'000;
  std::vector<int32_t> corners;
  for (int f = 0; f < kFaces; ++f) corners.insert(corners.end(), {0, 1, 2});
  const Topology topology =
      *Topology::Create(3, corners, std::vector<int32_t>(static_cast<size_t>(kFaces), 3));
  const std::string bytes = Encode(topology);
  EXPECT_LT(bytes.size(), 2000u);
  EXPECT_THAT(Decode(bytes, topology),
              HasStatus(absl::StatusCode::kResourceExhausted, testing::HasSubstr("open edges")));
}

TEST(FaceListCoderTest, DamagedCodeNeverDecodesToAnInvalidMesh) {
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

TEST(FreeNumbersTest, TakenNumbersAreFoundAndReturned) {
  FreeNumbers numbers(21);
  for (const int taken : {4, 0, 12, 20, 5, 7}) numbers.Take(taken);
  numbers.Return(5);
  const std::vector<int> taken = {0, 4, 7, 12, 20};
  ASSERT_EQ(numbers.num_taken(), static_cast<int>(taken.size()));
  for (size_t rank = 0; rank < taken.size(); ++rank) {
    EXPECT_EQ(numbers.SelectTaken(static_cast<int>(rank)), taken[rank]);
    EXPECT_EQ(taken[rank] - numbers.Rank(taken[rank]), static_cast<int>(rank));
  }
}

}  // namespace
}  // namespace pleat
