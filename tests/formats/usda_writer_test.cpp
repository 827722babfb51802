#include "pleat/formats/usda_writer.h"

#include "formats/painted_box.h"
#include "support/python_oracle.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(UsdaWriterTest, StagesSayTheirSpaceAndTimes) {
  const std::string text =
      EncodeUsda(PaintedBox(3), {.meters_per_unit = 0.01, .is_z_up = true, .first_frame = 1001});
  for (const char* line :
       {"#usda 1.0\n", "metersPerUnit = 0.01\n", "upAxis = \"Z\"\n", "startTimeCode = 1001\n",
        "endTimeCode = 1003\n", "timeCodesPerSecond = 29.97002997002997\n", "def Xform \"box__\"",
        "displayName = \"box \xc3\xa4\"", "point3f[] points.timeSamples = {\n            1001: [(",
        "def GeomSubset \"Stoff__\"", "rel material:binding = </box__/Materials/skin>",
        "uniform token elementType = \"face\"", "int[] faceVertexCounts = [4, 4, 4, 4, 4, 4]",
        "interpolation = \"faceVarying\""}) {
    EXPECT_THAT(text, HasSubstr(line));
  }
}

TEST(UsdaWriterTest, OneFrameHasNoTimeSamples) {
  EXPECT_THAT(EncodeUsda(PaintedBox(1)), Not(HasSubstr("timeSamples")));
}

TEST(UsdaWriterTest, BracketsPairUp) {
  const std::string text = EncodeUsda(PaintedBox(2, true));
  for (const char* pair : {"()", "[]", "{}"}) {
    EXPECT_EQ(std::ranges::count(text, pair[0]), std::ranges::count(text, pair[1])) << pair;
  }
}

TEST(UsdaWriterTest, NamesAreFitForPrims) {
  MeshSequenceOptions options{.name = "9/\"x\\\n"};
  options.appearance.material_names = {"a b", "a-b", ""};
  options.appearance.face_materials = {0, 1, 2, -1};
  Eigen::Matrix3Xi triangles(3, 4);
  triangles << 0, 0, 0, 1, 2, 1, 3, 2, 1, 3, 2, 3;
  const MeshSequence sequence = *MeshSequence::Create(*Topology::FromTriangles(4, triangles),
                                                      {Eigen::Matrix3Xf::Zero(3, 4)}, options);
  const std::string text = EncodeUsda(sequence);
  for (const char* line :
       {"def Xform \"_9__x__\"", "displayName = \"9/\\\"x\\\\ \"", "def Material \"a_b\"",
        "def Material \"a_b_2\"", "def Material \"material\""}) {
    EXPECT_THAT(text, HasSubstr(line));
  }
}

// The library itself must read the stage, with the same values.
TEST(UsdaWriterTest, OpenUsdAgrees) {
  PLEAT_PYTHON_OR_SKIP(python, "pxr");
  const TemporaryFolder folder;
  const MeshSequence sequence = PaintedBox(3, true);
  ASSERT_THAT(WriteUsda(folder.File("a.usda"), sequence, {.first_frame = 5}), IsOk());
  std::string expected;
  for (int t = 0; t < 3; ++t) {
    expected.append(reinterpret_cast<const char*>(sequence.frame(t).data()), 8 * 12);
  }
  std::ofstream(folder.File("expected.bin"), std::ios::binary) << expected;
  ASSERT_TRUE(RunScript(python, R"(
import array, sys
from pxr import Usd, UsdGeom, UsdShade
folder = sys.argv[1] + '/'
stage = Usd.Stage.Open(folder + 'a.usda')
values = array.array('f', open(folder + 'expected.bin', 'rb').read())
mesh = UsdGeom.Mesh(stage.GetDefaultPrim().GetChild('mesh'))
for t in range(3):
    points = mesh.GetPointsAttr().Get(5 + t)
    assert [x for p in points for x in p] == values[24 * t:24 * t + 24].tolist(), t
assert list(mesh.GetFaceVertexCountsAttr().Get()) == [3, 3, 4, 4, 4, 4, 4]
assert len(UsdShade.MaterialBindingAPI(mesh).GetMaterialBindSubsets()) == 2
assert UsdGeom.GetStageUpAxis(stage) == 'Y' and UsdGeom.GetStageMetersPerUnit(stage) == 1
)",
                        folder.path()));
}

}  // namespace
}  // namespace pleat
