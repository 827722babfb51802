#include "pleat/mesh/adjacency.h"

#include <gmock/gmock.h>

#include "support/mesh_shapes.h"

namespace pleat {
namespace {

using testing::ElementsAre;

TEST(AdjacencyTest, FollowsPolygonEdgesNotDiagonals) {
  const VertexAdjacency adjacency(MakeGrid(2, 1, 1, 1).topology);  // 0 1 2 / 3 4 5
  EXPECT_THAT(adjacency.neighbors(0), ElementsAre(1, 3));
  EXPECT_THAT(adjacency.neighbors(1), ElementsAre(0, 2, 4));
  EXPECT_THAT(adjacency.neighbors(5), ElementsAre(2, 4));
}

TEST(AdjacencyTest, LooseVerticesHaveNone) {
  const VertexAdjacency adjacency(*Topology::Create(5, {0, 2, 4}, {3}));
  EXPECT_EQ(adjacency.num_vertices(), 5);
  EXPECT_TRUE(adjacency.neighbors(1).empty());
  EXPECT_THAT(adjacency.neighbors(4), ElementsAre(0, 2));
}

TEST(AdjacencyTest, IsSymmetric) {
  const VertexAdjacency adjacency(MakeUvSphere(1, 6, 9).topology);
  for (int v = 0; v < adjacency.num_vertices(); ++v) {
    for (const int neighbor : adjacency.neighbors(v)) {
      EXPECT_THAT(adjacency.neighbors(neighbor), testing::Contains(v));
    }
  }
}

}  // namespace
}  // namespace pleat
