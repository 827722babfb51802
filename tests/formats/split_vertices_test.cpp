#include "split_vertices.h"

#include <gtest/gtest.h>

#include <set>
#include <tuple>

#include "support/mesh_shapes.h"

namespace pleat {
namespace {

// Two triangles over a square, 0 1 2 and 0 2 3.
Topology Square() { return Topology::Create(4, {0, 1, 2, 0, 2, 3}, {3, 3}).value(); }

TEST(SplitVerticesTest, AMeshWithoutTextureCoordinatesStaysAsItIs) {
  const SplitVertices split = SplitAtSeams(Square(), {});
  EXPECT_EQ(split.sources, (std::vector<int32_t>{0, 1, 2, 3}));
  EXPECT_TRUE(split.texcoords.empty());
  EXPECT_TRUE(split.triangle_materials.empty());
  EXPECT_EQ(split.triangles, Square().triangles());
}

TEST(SplitVerticesTest, AVertexIsRepeatedForEachOfItsTextureCoordinates) {
  MeshAppearance appearance;
  appearance.texcoords = {{0, 0}, {1, 0}, {1, 1}, {.5f, .5f}, {0, 1}};
  appearance.corner_texcoords = {0, 1, 2, 3, 2, 4};  // vertex 0 has two, vertex 2 one
  const SplitVertices split = SplitAtSeams(Square(), appearance);
  ASSERT_EQ(split.sources.size(), 5u);
  EXPECT_EQ(split.sources[4], 0);
  EXPECT_EQ(split.triangles(0, 0), 0);
  EXPECT_EQ(split.triangles(0, 1), 4);
  EXPECT_EQ(split.triangles(2, 0), split.triangles(1, 1));
  for (int t = 0; t < 2; ++t) {
    for (int corner = 0; corner < 3; ++corner) {
      const int v = split.triangles(corner, t);
      EXPECT_EQ(split.sources[v], Square().triangles()(corner, t));
      EXPECT_EQ(split.texcoords[v],
                appearance.texcoords[appearance.corner_texcoords[3 * t + corner]]);
    }
  }
}

TEST(SplitVerticesTest, EqualCoordinatesOfDifferentNumbersAreOne) {
  MeshAppearance appearance;
  appearance.texcoords = {{0, 0}, {1, 0}, {1, 1}, {0, 0}, {0, 1}};
  appearance.corner_texcoords = {0, 1, 2, 3, 2, 4};
  EXPECT_EQ(SplitAtSeams(Square(), appearance).sources.size(), 4u);
}

TEST(SplitVerticesTest, CornersWithoutCoordinatesHaveZeros) {
  MeshAppearance appearance;
  appearance.texcoords = {{.25f, .75f}};
  appearance.corner_texcoords = {0, -1, -1, 0, -1, -1};
  const SplitVertices split = SplitAtSeams(Square(), appearance);
  EXPECT_EQ(split.texcoords[split.triangles(0, 0)], Eigen::Vector2f(.25f, .75f));
  EXPECT_EQ(split.texcoords[split.triangles(1, 0)], Eigen::Vector2f(0, 0));
}

TEST(SplitVerticesTest, TrianglesOfAPolygonHaveItsMaterial) {
  const MeshShape box = MakeBox({1, 1, 1});
  MeshAppearance appearance;
  appearance.material_names = {"a", "b"};
  appearance.face_materials = {0, 1, -1, 0, 1, -1};
  const SplitVertices split = SplitAtSeams(box.topology, appearance);
  ASSERT_EQ(split.triangle_materials.size(), static_cast<size_t>(box.topology.num_triangles()));
  EXPECT_EQ(std::set<int32_t>(split.triangle_materials.begin(), split.triangle_materials.end()),
            (std::set<int32_t>{-1, 0, 1}));
  EXPECT_EQ(std::count(split.triangle_materials.begin(), split.triangle_materials.end(), 1), 4);
}

}  // namespace
}  // namespace pleat
