#include "pleat/mesh/adjacency.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <functional>

#include "pleat/mesh/edge_sides.h"
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

// The other way to the same edges.
TEST(AdjacencyTest, ListsAscendAndHoldEveryEdgeOnce) {
  for (const MeshShape& shape : {MakeUvSphere(1, 6, 9), MakeGrid(4, 3, 1, 1), MakeBox({1, 1, 1})}) {
    const VertexAdjacency adjacency(shape.topology);
    const std::vector<EdgeSide> sides = SortedEdgeSides(shape.topology);
    size_t num_edges = 0, num_neighbors = 0;
    for (size_t begin = 0; begin < sides.size(); begin = EndOfEdge(sides, begin)) {
      EXPECT_THAT(adjacency.neighbors(sides[begin].low), testing::Contains(sides[begin].high));
      ++num_edges;
    }
    for (int v = 0; v < adjacency.num_vertices(); ++v) {
      const auto neighbors = adjacency.neighbors(v);
      EXPECT_TRUE(std::is_sorted(neighbors.begin(), neighbors.end(), std::less_equal<>()));
      num_neighbors += neighbors.size();
    }
    EXPECT_EQ(num_neighbors, 2 * num_edges);
  }
}

TEST(AdjacencyTest, ARepeatedCornerIsNotItsOwnNeighbor) {
  const VertexAdjacency adjacency(*Topology::Create(3, {0, 1, 1, 2}, {4}));
  EXPECT_THAT(adjacency.neighbors(1), ElementsAre(0, 2));
}

}  // namespace
}  // namespace pleat
