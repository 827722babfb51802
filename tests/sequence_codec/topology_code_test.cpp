// What both coders of faces owe: any polygon soup comes back, no damage goes through.
#include "sequence_codec/topology_code.h"

#include "support/hostile_bytes.h"
#include "support/test_meshes.h"

namespace pleat {
namespace {

template <typename Code>
class TopologyCodeTest : public testing::Test {};
using Codes = testing::Types<SurfaceCode, FaceListCode>;
TYPED_TEST_SUITE(TopologyCodeTest, Codes);

TYPED_TEST(TopologyCodeTest, PolygonsBordersAndLonelyVerticesRoundTrip) {
  TypeParam::ExpectRoundTrip(*Topology::Create(9, {7, 0, 1, 2, 3, 2, 1, 8, 0, 7, 4}, {5, 3, 3}));
}

TYPED_TEST(TopologyCodeTest, PolygonSoupRoundTrips) {
  // A fin of three faces, a doubled face, one face in both orientations, a repeated corner.
  TypeParam::ExpectRoundTrip(*Topology::Create(
      8, {0, 1, 2, 1, 0, 3, 0, 1, 4, 0, 1, 2, 5, 6, 7, 7, 6, 5, 3, 3, 4}, {3, 3, 3, 3, 3, 3, 3}));
}

TYPED_TEST(TopologyCodeTest, NoFacesRoundTrip) {
  TypeParam::ExpectRoundTrip(*Topology::Create(3, {}, {}));
}

TYPED_TEST(TopologyCodeTest, DamagedCodeNeverDecodesToAnInvalidMesh) {
  const TestMesh mesh = MakeTorus(8, 6, 3);
  const std::string bytes = TypeParam::Encode(mesh.topology);
  ForEachTruncation(bytes, [&](const std::string& damaged) {
    const absl::StatusOr<Topology> decoded = TypeParam::Decode(damaged, mesh.topology);
    EXPECT_TRUE(!decoded.ok() || decoded->num_corners() == mesh.topology.num_corners());
  });
  ForEachCorruption(bytes, [&](const std::string& damaged) {
    const absl::StatusOr<Topology> decoded = TypeParam::Decode(damaged, mesh.topology);
    EXPECT_TRUE(!decoded.ok() || decoded->num_corners() == mesh.topology.num_corners());
  });
  EXPECT_THAT(TypeParam::Decode("", mesh.topology), testing::Not(IsOk()));
}

}  // namespace
}  // namespace pleat
