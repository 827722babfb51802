#include <gmock/gmock.h>

#include "formats/figure_character.h"
#include "formats/gltf_evaluation.h"
#include "formats/painted_box.h"
#include "pleat/formats/rig_file.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

Eigen::Matrix3Xd SkinnedFrame(const CharacterFile& character, const Eigen::Matrix3Xd& rest,
                              int frame) {
  BoneTransforms transforms;
  ComputeBoneTransforms(character.rig.skeleton, character.track.pose(frame), {}, &transforms);
  Eigen::Matrix3Xd positions;
  SkinVertices(character.rig.weights, rest, transforms, &positions);
  return positions;
}

TEST(CharacterGlbWriterTest, AnEngineShowsTheSkinnedFrames) {
  const CharacterFile character = FigureCharacter(12);
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::string bytes, EncodeCharacterGlb(character));
  const GltfEvaluation gltf(bytes);
  ASSERT_EQ(gltf.num_keys(), 12u);
  for (int t = 0; t < 12; ++t) {
    const Eigen::Matrix3Xd truth = SkinnedFrame(character, character.rig.rest_positions, t);
    const Eigen::Matrix3Xd shown = gltf.Positions(static_cast<size_t>(t));
    ASSERT_EQ(shown.cols(), truth.cols());
    EXPECT_LT((shown - truth).colwise().norm().maxCoeff(), 3e-6) << t;
  }
}

TEST(CharacterGlbWriterTest, MorphTargetsAreAddedBeforeTheSkin) {
  CharacterFile character = FigureCharacter(5);
  const Eigen::Index num_values = character.rig.rest_positions.size();
  MorphBasis morphs;
  morphs.targets = .01f * Eigen::MatrixXf::Random(num_values, 3);
  morphs.weights = Eigen::MatrixXf::Random(5, 3);
  character.morphs = morphs;
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::string bytes, EncodeCharacterGlb(character));
  const GltfEvaluation gltf(bytes);
  for (int t = 0; t < 5; ++t) {
    const Eigen::VectorXd folds =
        morphs.targets.cast<double>() * morphs.weights.row(t).transpose().cast<double>();
    const Eigen::Matrix3Xd rest = character.rig.rest_positions + folds.reshaped(3, num_values / 3);
    EXPECT_LT((gltf.Positions(static_cast<size_t>(t)) - SkinnedFrame(character, rest, t))
                  .colwise()
                  .norm()
                  .maxCoeff(),
              3e-6);
  }
  const nlohmann::json& mesh = gltf.root["meshes"][0];
  EXPECT_EQ(mesh["extras"]["targetNames"],
            (std::vector<std::string>{"base_folds", "folds_1", "folds_2"}));
  EXPECT_EQ(mesh["weights"].size(), 3u);
}

TEST(CharacterGlbWriterTest, OurOwnReaderGivesTheSameRig) {
  const CharacterFile character = FigureCharacter(3);
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::string bytes, EncodeCharacterGlb(character));
  PLEAT_ASSERT_OK_AND_ASSIGN(const RigFile file, DecodeRigGlb(bytes));
  const MeshSequence clip =
      *MeshSequence::Create(character.topology, {character.rig.rest_positions.cast<float>()}, {});
  PLEAT_ASSERT_OK_AND_ASSIGN(const UserRig rig, ResolveRig(file, clip));
  const Skeleton& skeleton = character.rig.skeleton;
  ASSERT_EQ(rig.skeleton.num_joints(), skeleton.num_joints());
  for (int j = 0; j < skeleton.num_joints(); ++j) {
    EXPECT_EQ(rig.skeleton.joint(j).name, skeleton.joint(j).name);
    EXPECT_EQ(rig.skeleton.parent(j), skeleton.parent(j));
    EXPECT_LT((rig.skeleton.rest_position(j) - skeleton.rest_position(j)).norm(), 1e-6);
  }
  ASSERT_TRUE(rig.weights.has_value());
  for (int v = 0; v < character.topology.num_vertices(); ++v) {
    const VertexInfluences &read = rig.weights->vertex(v),
                           &written = character.rig.weights.vertex(v);
    for (int k = 0; k < kMaxInfluences && written.weights[k] > 0; ++k) {
      EXPECT_EQ(read.bones[k], written.bones[k]) << v;
      EXPECT_NEAR(read.weights[k], written.weights[k], 2e-7) << v;
    }
  }
}

TEST(CharacterGlbWriterTest, MaterialsTexcoordsAndVertexNumbersAreThere) {
  const MeshSequence box = PaintedBox(1, true);
  CharacterFile character;
  character.name = "box";
  character.topology = box.topology();
  character.appearance = box.appearance();
  character.rig.skeleton = *Skeleton::Create({{"a", -1, {0, 0, 0}}, {"b", 0, {0, 1, 0}}});
  character.rig.rest_positions = box.FrameAsDouble(0);
  character.rig.weights = *SkinWeights::Create(
      2, std::vector<VertexInfluences>(box.num_vertices(), {{1, 0, 0, 0}, {1, 0, 0, 0}}));
  PLEAT_ASSERT_OK_AND_ASSIGN(const std::string bytes, EncodeCharacterGlb(character));
  const GltfEvaluation gltf(bytes);
  EXPECT_FALSE(gltf.root.contains("animations"));
  EXPECT_EQ(gltf.root["materials"].size(), box.appearance().material_names.size());
  const std::vector<double> ids = gltf.Numbers(gltf.attributes()["_VERTEX_ID"]);
  EXPECT_EQ(gltf.Numbers(gltf.attributes()["TEXCOORD_0"]).size(), 2 * ids.size());
  EXPECT_GT(ids.size(), static_cast<size_t>(box.num_vertices()));  // seams repeat vertices
  const Eigen::Matrix3Xd positions = gltf.Positions(0);
  const std::vector<double> normals = gltf.Numbers(gltf.attributes()["NORMAL"]);
  for (size_t v = 0; v < ids.size(); ++v) {
    EXPECT_LT((positions.col(v) - character.rig.rest_positions.col(ids[v])).norm(), 1e-6);
    EXPECT_NEAR(std::hypot(normals[3 * v], normals[3 * v + 1], normals[3 * v + 2]), 1, 1e-6);
  }
}

TEST(CharacterGlbWriterTest, WhatIsLargerThanAGlbIsRefused) {
  CharacterFile character = FigureCharacter(1);
  character.topology = *Topology::Create(4'000'000, {0, 1, 2}, {3});
  character.rig.rest_positions = Eigen::Matrix3Xd::Zero(3, 4'000'000);
  MorphBasis morphs;
  morphs.targets.resize(0, 100);  // only the count is asked before the size is known
  character.morphs = morphs;
  EXPECT_THAT(EncodeCharacterGlb(character),
              HasStatus(absl::StatusCode::kResourceExhausted, testing::HasSubstr("fewer targets")));
}

}  // namespace
}  // namespace pleat
