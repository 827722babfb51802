#include "export_skin.h"

#include "formats/figure_character.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

TEST(ExportSkinTest, WeightsGoToTheJointsThatTurnTheBones) {
  const CharacterFile character = FigureCharacter(0);
  const std::vector<ExportJoint> joints = MakeExportJoints(character.rig.skeleton);
  const std::vector<ExportInfluences> influences =
      MakeExportInfluences(character.rig.weights, joints);
  ASSERT_EQ(influences.size(), static_cast<size_t>(character.topology.num_vertices()));
  for (size_t v = 0; v < influences.size(); ++v) {
    const VertexInfluences& given = character.rig.weights.vertex(static_cast<int>(v));
    double sum = 0;
    for (size_t k = 0; k < kMaxInfluences; ++k) {
      sum += influences[v].weights[k];
      EXPECT_NEAR(influences[v].weights[k], given.weights[k], 2e-7);
      if (given.weights[k] > 0) {
        EXPECT_EQ(joints[influences[v].joints[k]].turning_bone, given.bones[k]);
      } else {
        EXPECT_EQ(influences[v].joints[k], 0);
      }
    }
    EXPECT_NEAR(sum, 1, 2e-7);
  }
}

TEST(ExportSkinTest, SumsThatAreOffAreMadeOne) {
  const std::vector<ExportJoint> joints = MakeExportJoints(
      *Skeleton::Create({{"a", -1, {0, 0, 0}}, {"b", 0, {0, 1, 0}}, {"c", 1, {0, 2, 0}}}));
  const SkinWeights weights =
      *SkinWeights::Create(3, {{{1, 2, 0, 0}, {.60004f, .4f, 0, 0}}, {{2}, {1}}});
  const std::vector<ExportInfluences> influences = MakeExportInfluences(weights, joints);
  EXPECT_NEAR(double{influences[0].weights[0]} + influences[0].weights[1], 1, 1e-7);
  EXPECT_EQ(influences[1].weights[0], 1);
  EXPECT_EQ(MostInfluences(weights), 2);
}

}  // namespace
}  // namespace pleat
