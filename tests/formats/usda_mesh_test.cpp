#include "usda_mesh.h"

#include "formats/painted_box.h"

namespace pleat {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

TEST(UsdaMeshTest, FacesAndMaterialsAreSaid) {
  const MeshSequence box = PaintedBox(1);
  const UsdaMesh mesh(box.topology(), box.appearance(), "root");
  std::string text;
  mesh.AppendFaces(&text);
  EXPECT_THAT(text, HasSubstr("faceVertexCounts = [4, 4, 4, 4, 4, 4]"));
  mesh.AppendSubsets(&text);
  EXPECT_THAT(text, HasSubstr("indices = [2, 3, 4, 5]"));
  EXPECT_THAT(text, HasSubstr("</root/Materials/skin>"));
  mesh.AppendTexcoords(&text);
  EXPECT_THAT(text, HasSubstr("primvars:st:indices"));
  mesh.AppendMaterials(&text);
  EXPECT_THAT(text, HasSubstr("def Material \"Stoff__\""));
  EXPECT_TRUE(mesh.has_materials());
}

TEST(UsdaMeshTest, AMeshWithoutAppearanceHasNeither) {
  const MeshSequence box = PaintedBox(1);
  const MeshAppearance plain;
  const UsdaMesh mesh(box.topology(), plain, "root");
  std::string text;
  mesh.AppendSubsets(&text);
  mesh.AppendTexcoords(&text);
  mesh.AppendMaterials(&text);
  EXPECT_THAT(text, IsEmpty());
}

}  // namespace
}  // namespace pleat
