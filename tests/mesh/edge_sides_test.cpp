#include "pleat/mesh/edge_sides.h"

#include <gmock/gmock.h>

#include "support/mesh_shapes.h"

namespace pleat {
namespace {

using testing::FieldsAre;

// Two triangles that share the edge 1-2 and run along it both ways.
TEST(EdgeSidesTest, AreSortedByEdgeAndFace) {
  const Topology topology = *Topology::Create(4, {0, 1, 2, 3, 2, 1}, {3, 3});
  const auto expected = testing::ElementsAre(FieldsAre(0, 1, 0, true), FieldsAre(0, 2, 0, false),
                                             FieldsAre(1, 2, 0, true), FieldsAre(1, 2, 1, false),
                                             FieldsAre(1, 3, 1, true), FieldsAre(2, 3, 1, false));
  EXPECT_THAT(SortedEdgeSides(topology), expected);
  EXPECT_THAT(SortedEdgeSides(topology.triangles()), expected);
}

TEST(EdgeSidesTest, EndOfEdgeCountsTheFacesOfAnEdge) {
  // Three triangles around the edge 0-1.
  const std::vector<EdgeSide> sides =
      SortedEdgeSides(*Topology::Create(5, {0, 1, 2, 1, 0, 3, 0, 1, 4}, {3, 3, 3}));
  EXPECT_EQ(EndOfEdge(sides, 0), 3u);
  EXPECT_EQ(EndOfEdge(sides, 3), 4u);
}

TEST(EdgeSidesTest, ARepeatedCornerMakesNoEdge) {
  EXPECT_EQ(SortedEdgeSides(*Topology::Create(3, {0, 1, 1, 2}, {4})).size(), 3u);
}

TEST(EdgeSidesTest, AClosedSurfaceRunsAlongEveryEdgeBothWays) {
  const MeshShape sphere = MakeUvSphere(1, 5, 8);
  const std::vector<EdgeSide> sides = SortedEdgeSides(sphere.topology);
  EXPECT_EQ(sides.size(), static_cast<size_t>(sphere.topology.num_corners()));
  for (size_t begin = 0; begin < sides.size(); begin += 2) {
    ASSERT_EQ(EndOfEdge(sides, begin), begin + 2);
    EXPECT_NE(sides[begin].forward, sides[begin + 1].forward);
    EXPECT_LT(sides[begin].face, sides[begin + 1].face);
  }
}

}  // namespace
}  // namespace pleat
