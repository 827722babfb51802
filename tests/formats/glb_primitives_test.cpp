#include "glb_primitives.h"

#include "formats/painted_box.h"
#include "glb_container.h"

namespace pleat {
namespace {

TEST(GlbPrimitivesTest, FacesOfAMaterialArePrimitivesWithTheSameVertices) {
  const MeshSequence box = PaintedBox(1, true);
  const GlbPrimitives mesh(box.topology(), box.appearance());
  GlbBuffers buffers(1000);
  nlohmann::json attributes = nlohmann::json::object(), root;
  mesh.AddTexcoords(&buffers, &attributes);
  mesh.AddVertexIds(&buffers, &attributes);
  const nlohmann::json primitives = mesh.Primitives(attributes, {}, &buffers);
  AddGlbMaterials(box.appearance(), &root);
  ASSERT_EQ(primitives.size(), 2u);
  EXPECT_EQ(root["materials"].size(), 2u);
  for (size_t p = 0; p < 2; ++p) {
    EXPECT_EQ(primitives[p]["material"], p);
    EXPECT_EQ(primitives[p]["attributes"], attributes);
    EXPECT_FALSE(primitives[p].contains("targets"));
  }
  const nlohmann::json targets = {{{"POSITION", 0}}};
  EXPECT_EQ(mesh.Primitives(attributes, targets, &buffers)[1]["targets"], targets);
}

TEST(GlbPrimitivesTest, RepetitionsOfAVertexHaveItsValues) {
  const MeshSequence box = PaintedBox(1);
  const GlbPrimitives mesh(box.topology(), box.appearance());
  const Eigen::Matrix3Xf spread = mesh.Spread(box.frame(0));
  ASSERT_EQ(static_cast<size_t>(spread.cols()), mesh.num_vertices());
  ASSERT_GT(mesh.num_vertices(), 8u);
  for (size_t v = 0; v < mesh.num_vertices(); ++v) {
    EXPECT_EQ(spread.col(v), box.frame(0).col(mesh.sources()[v]));
  }
  EXPECT_EQ(mesh.num_triangles(), 12u);
}

}  // namespace
}  // namespace pleat
