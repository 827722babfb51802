#include <gmock/gmock.h>

#include "formats/figure_character.h"
#include "support/python_oracle.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(CharacterUsdaWriterTest, TheTextHasASkeletonAndASkinnedMesh) {
  CharacterFile character = FigureCharacter(2);
  character.name = "my figure";
  const std::string text = EncodeCharacterUsda(character);
  for (const char* part :
       {"#usda 1.0", "def SkelRoot \"my_figure\"", "def Skeleton \"skeleton\"",
        "\"hips/leftUpperLeg_bone/leftUpperLeg/leftLowerLeg\"",
        "rel skel:animationSource = </my_figure/skeleton/animation>",
        "quatf[] rotations.timeSamples", "rel skel:skeleton = </my_figure/skeleton>",
        "interpolation = \"vertex\"", "endTimeCode = 1"}) {
    EXPECT_THAT(text, HasSubstr(part));
  }
  EXPECT_THAT(text, Not(HasSubstr("full_mesh")));
  EXPECT_THAT(EncodeCharacterUsda(FigureCharacter(0)), Not(HasSubstr("SkelAnimation")));
}

TEST(CharacterUsdaWriterTest, TheWholeMeshIsShownInPlaceOfTheSkinnedOne) {
  CharacterFile character = FigureCharacter(2);
  character.points.assign(2, character.rig.rest_positions.cast<float>());
  const std::string text = EncodeCharacterUsda(character);
  EXPECT_THAT(text, HasSubstr("def Mesh \"full_mesh\""));
  EXPECT_THAT(text, HasSubstr("point3f[] points.timeSamples"));
  EXPECT_THAT(text, HasSubstr("token visibility = \"invisible\""));
}

// OpenUSD itself skins the mesh; the frames are those of our own skinning.
constexpr char kSkinWithUsd[] = R"(
import sys
from pxr import Usd, UsdGeom, UsdSkel
folder = sys.argv[1]
stage = Usd.Stage.Open(folder + '/figure.usda')
root = UsdSkel.Root(stage.GetDefaultPrim())
assert root and UsdGeom.GetStageMetersPerUnit(stage) == 1
cache = UsdSkel.Cache()
cache.Populate(root, Usd.TraverseInstanceProxies())
mesh = stage.GetPrimAtPath('/figure/mesh')
skinning = cache.GetSkinningQuery(mesh)
skeleton = cache.GetSkelQuery(UsdSkel.Skeleton(stage.GetPrimAtPath('/figure/skeleton')))
assert skinning and skeleton.GetAnimQuery()
truth = [float(x) for x in open(folder + '/truth.txt').read().split()]
worst = 0
for t in range(int(stage.GetEndTimeCode()) + 1):
    points = UsdGeom.Mesh(mesh).GetPointsAttr().Get()
    transforms = skeleton.ComputeSkinningTransforms(t)
    assert skinning.ComputeSkinnedPoints(transforms, points, t)
    for p in points:
        for k in range(3):
            worst = max(worst, abs(p[k] - truth.pop(0)))
assert not truth
print('worst', worst)
sys.exit(0 if worst < 1e-5 else 1)
)";

TEST(CharacterUsdaWriterTest, OpenUsdSkinsTheFrames) {
  PLEAT_PYTHON_OR_SKIP(python, "pxr");
  const CharacterFile character = FigureCharacter(4);
  const TemporaryFolder folder;
  ASSERT_THAT(WriteCharacterUsda(folder.File("figure.usda"), character), IsOk());
  std::ofstream truth(folder.File("truth.txt"));
  truth.precision(9);
  BoneTransforms transforms;
  Eigen::Matrix3Xd positions;
  for (const Pose& pose : character.track.poses()) {
    ComputeBoneTransforms(character.rig.skeleton, pose, {}, &transforms);
    SkinVertices(character.rig.weights, character.rig.rest_positions, transforms, &positions);
    for (const double value : positions.reshaped()) truth << value << '\n';
  }
  truth.close();
  EXPECT_TRUE(RunScript(python, kSkinWithUsd, folder.File("")));
}

}  // namespace
}  // namespace pleat
