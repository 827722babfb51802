// Characters as other programs show them: Khronos's validator and three.js under node (npm packages
// gltf-validator and three), and Blender. Each test skips where its program is not.
#include <gmock/gmock.h>

#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>

#include "formats/figure_character.h"
#include "formats/painted_box.h"
#include "pleat/base/file.h"
#include "pleat/formats/bvh.h"
#include "pleat/formats/glb_writer.h"
#include "pleat/formats/mdd.h"
#include "pleat/formats/motion_reader.h"
#include "pleat/formats/rig_file.h"
#include "support/programs.h"
#include "support/source_folder.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using testing::StartsWith;

constexpr int kNumFrames = 6;

CharacterFile FoldedFigure() {
  CharacterFile character = FigureCharacter(kNumFrames);
  character.frame_rate = {30, 1};
  PoseTrack::Parts parts = character.track.parts();
  parts.fps = 30;
  character.track = PoseTrack::FromValid(std::move(parts));
  MorphBasis morphs;
  const Eigen::Index num_values = character.rig.rest_positions.size();
  morphs.targets.resize(num_values, 2);
  for (Eigen::Index i = 0; i < num_values; ++i) {
    const auto phase = static_cast<float>(i);
    morphs.targets.row(i) << .01f * std::sin(.3f * phase), .02f * std::cos(.7f * phase);
  }
  morphs.weights.resize(kNumFrames, 2);
  for (int t = 0; t < kNumFrames; ++t) {
    morphs.weights.row(t) << 1, .5f + .5f * std::sin(static_cast<float>(t));
  }
  character.morphs = morphs;
  return character;
}

// All frames of the character one after the other, 3 x (T V): what a program should show.
Eigen::Matrix3Xd Shown(const CharacterFile& character) {
  const Eigen::Index num_vertices = character.rig.rest_positions.cols();
  Eigen::Matrix3Xd all(3, num_vertices * character.track.num_frames());
  BoneTransforms transforms;
  Eigen::Matrix3Xd positions;
  for (int t = 0; t < character.track.num_frames(); ++t) {
    ComputeBoneTransforms(character.rig.skeleton, character.track.pose(t), {}, &transforms);
    const Eigen::VectorXd folds =
        (character.morphs->targets * character.morphs->weights.row(t).transpose()).cast<double>();
    SkinVertices(character.rig.weights,
                 character.rig.rest_positions + folds.reshaped(3, num_vertices), transforms,
                 &positions);
    all.middleCols(t * num_vertices, num_vertices) = positions;
  }
  return all;
}

Eigen::Matrix3Xd ReadPoints(std::istream& text) {
  std::vector<double> values;
  for (double value; text >> value;) values.push_back(value);
  return Eigen::Map<const Eigen::Matrix3Xd>(values.data(), 3,
                                            static_cast<Eigen::Index>(values.size() / 3));
}

std::string Node(const std::string& script, const std::string& file) {
  return OutputOf("node " + InSourceFolder("tests/formats/" + script) + " " + file + " 2>&1");
}

TEST(OtherProgramsTest, TheValidatorOfGltfFindsNothing) {
  if (!HasNodePackage("gltf-validator")) {
    GTEST_SKIP() << "node with the package gltf-validator is not on this machine (NODE_PATH)";
  }
  const TemporaryFolder folder;
  ASSERT_THAT(WriteCharacterGlb(folder.File("folded.glb"), FoldedFigure()), IsOk());
  ASSERT_THAT(WriteCharacterGlb(folder.File("still.glb"), FigureCharacter(0)), IsOk());
  CharacterFile painted = FigureCharacter(0);
  const MeshSequence box = PaintedBox(3, true);
  painted.topology = box.topology();
  painted.appearance = box.appearance();
  painted.rig.rest_positions = box.FrameAsDouble(0);
  painted.rig.weights = *SkinWeights::Create(
      18, std::vector<VertexInfluences>(8, {{3, 1, 0, 0}, {.75f, .25f, 0, 0}}));
  ASSERT_THAT(WriteCharacterGlb(folder.File("painted.glb"), painted), IsOk());
  ASSERT_THAT(WriteGlb(folder.File("frames.glb"), box), IsOk());
  for (const char* name : {"folded.glb", "still.glb", "painted.glb", "frames.glb"}) {
    EXPECT_THAT(Node("gltf_validator.js", folder.File(name)), StartsWith("0 0\n")) << name;
  }
}

TEST(OtherProgramsTest, ThreeJsShowsSkinMotionAndFolds) {
  if (!HasNodePackage("three")) {
    GTEST_SKIP() << "node with the package three is not on this machine (NODE_PATH)";
  }
  const TemporaryFolder folder;
  const CharacterFile character = FoldedFigure();
  ASSERT_THAT(WriteCharacterGlb(folder.File("figure.glb"), character), IsOk());
  std::istringstream text(Node("three_figure.mjs", folder.File("figure.glb")));
  const Eigen::Matrix3Xd shown = ReadPoints(text), wanted = Shown(character);
  ASSERT_EQ(shown.cols(), wanted.cols()) << text.str();
  EXPECT_LT((shown - wanted).colwise().norm().maxCoeff(), 1e-5);
}

// three.js reads UsdSkel by code of its own. It splits the mesh into corners, each of which must
// move with the same vertex in all frames.
TEST(OtherProgramsTest, ThreeJsSkinsTheUsdText) {
  if (!HasNodePackage("three/examples/jsm/loaders/USDLoader.js")) {
    GTEST_SKIP() << "node with a package three that has USDLoader.js is not here (NODE_PATH)";
  }
  const TemporaryFolder folder;
  CharacterFile character = FoldedFigure();
  character.morphs->targets.setZero();  // USD text has none
  ASSERT_THAT(WriteCharacterUsda(folder.File("figure.usda"), character), IsOk());
  std::istringstream text(Node("three_figure.mjs", folder.File("figure.usda")));
  const Eigen::Matrix3Xd shown = ReadPoints(text), wanted = Shown(character);
  const Eigen::Index num_vertices = character.rig.rest_positions.cols();
  const Eigen::Index num_corners = shown.cols() / kNumFrames;
  ASSERT_EQ(num_corners * kNumFrames, shown.cols());
  ASSERT_EQ(num_corners, 3 * character.topology.num_triangles()) << text.str();
  for (Eigen::Index c = 0; c < num_corners; ++c) {
    Eigen::Index vertex = 0;
    (wanted.leftCols(num_vertices).colwise() - shown.col(c)).colwise().norm().minCoeff(&vertex);
    for (int t = 0; t < kNumFrames; ++t) {
      EXPECT_LT((shown.col(t * num_corners + c) - wanted.col(t * num_vertices + vertex)).norm(),
                1e-5)
          << c << " " << t;
    }
  }
}

TEST(OtherProgramsTest, ThreeJsPlacesTheJointsOfABvh) {
  if (!HasNodePackage("three")) {
    GTEST_SKIP() << "node with the package three is not on this machine (NODE_PATH)";
  }
  const TemporaryFolder folder;
  const CharacterFile character = FoldedFigure();
  const std::string bvh = EncodeBvh(ClipFromPoses(character.rig.skeleton, character.track));
  ASSERT_THAT(WriteFile(folder.File("figure.bvh"), bvh), IsOk());
  PLEAT_ASSERT_OK_AND_ASSIGN(const BvhFile file, DecodeBvh(bvh));
  std::istringstream text(Node("three_figure.mjs", folder.File("figure.bvh")));
  const Eigen::Matrix3Xd shown = ReadPoints(text);
  const auto num_joints = static_cast<Eigen::Index>(file.clip.num_joints());
  ASSERT_EQ(shown.cols(), num_joints * kNumFrames) << text.str();
  PlacedJoints placed;
  for (int t = 0; t < kNumFrames; ++t) {
    PlaceJoints(file.clip, static_cast<size_t>(t), &placed);
    EXPECT_LT((shown.middleCols(t * num_joints, num_joints) - placed.positions)
                  .colwise()
                  .norm()
                  .maxCoeff(),
              1e-4);  // centimeters
  }
}

TEST(OtherProgramsTest, ThreeJsReadsTheFramesOfAnMdd) {
  if (!HasNodePackage("three")) {
    GTEST_SKIP() << "node with the package three is not on this machine (NODE_PATH)";
  }
  const TemporaryFolder folder;
  const MeshSequence box = PaintedBox(3, true);
  MddCache cache;
  for (int t = 0; t < box.num_frames(); ++t) {
    cache.times_s.push_back(static_cast<float>(t) / 30);
    cache.frames.push_back(box.frame(t));
  }
  ASSERT_THAT(WriteMdd(folder.File("box.mdd"), cache), IsOk());
  std::istringstream text(Node("three_figure.mjs", folder.File("box.mdd")));
  const Eigen::Matrix3Xd shown = ReadPoints(text);
  ASSERT_EQ(shown.cols(), 3 * box.num_vertices()) << text.str();
  for (int t = 0; t < 3; ++t) {
    EXPECT_LT((shown.middleCols(t * box.num_vertices(), box.num_vertices()) - box.FrameAsDouble(t))
                  .cwiseAbs()
                  .maxCoeff(),
              1e-6);
  }
}

// Everything that Blender does with a character, in one start of it.
class BlenderTest : public testing::Test {
 protected:
  void SetUp() override {
    if (OutputOf("blender --version 2>/dev/null").empty()) {
      GTEST_SKIP() << "blender is not on this machine";
    }
    ASSERT_THAT(WriteCharacterGlb(folder_.File("figure.glb"), character_), IsOk());
    ASSERT_THAT(WriteBvh(folder_.File("figure.bvh"),
                         ClipFromPoses(character_.rig.skeleton, character_.track)),
                IsOk());
    const std::string log =
        OutputOf("blender -b --python-exit-code 1 -P " +
                 InSourceFolder("tests/formats/blender_character.py") + " -- " + folder_.File("") +
                 " " + std::to_string(kNumFrames) + " 30 2>&1");
    ASSERT_THAT(ReadFile(folder_.File("back.glb")), IsOk()) << log;
    ASSERT_THAT(ReadFile(folder_.File("joints.txt")), IsOk()) << log;
  }

  const TemporaryFolder folder_;
  const CharacterFile character_ = FoldedFigure();
};

TEST_F(BlenderTest, ShowsTheSameAndGivesTheMotionBack) {
  std::ifstream mesh(folder_.File("mesh.txt"));
  const Eigen::Matrix3Xd shown = ReadPoints(mesh), wanted = Shown(character_);
  ASSERT_EQ(shown.cols(), wanted.cols());
  EXPECT_LT((shown - wanted).colwise().norm().maxCoeff(), 1e-4);

  std::ifstream joints(folder_.File("joints.txt"));
  int frame = 0, num_compared = 0;
  std::string name;
  Eigen::Vector3d place;
  BoneTransforms transforms;
  while (joints >> frame >> name >> place.x() >> place.y() >> place.z()) {
    const int joint = character_.rig.skeleton.FindJoint(name);
    if (joint < 0) continue;
    ComputeBoneTransforms(character_.rig.skeleton, character_.track.pose(frame), {}, &transforms);
    EXPECT_LT((place - transforms.joint_positions.col(joint)).norm(), 1e-4) << name << frame;
    ++num_compared;
  }
  EXPECT_EQ(num_compared, 18 * kNumFrames);

  PLEAT_ASSERT_OK_AND_ASSIGN(const Motion motion,
                             ReadMotion(folder_.File("back.glb"), character_.rig.skeleton));
  EXPECT_LT(TrackDifference(motion.track, character_.track), 1e-4);
  EXPECT_EQ(motion.track.fps(), 30);
  PLEAT_ASSERT_OK_AND_ASSIGN(const RigFile rig, ReadRigFile(folder_.File("back.glb")));
  EXPECT_EQ(rig.skeleton.num_joints(), 18);
}

}  // namespace
}  // namespace pleat
