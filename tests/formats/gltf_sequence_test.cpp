// Animations of glTF files that other programs would write.
#include "gltf_sequence.h"

#include <Eigen/Geometry>
#include <cmath>

#include "figure_glb.h"
#include "formats/painted_box.h"
#include "pleat/base/file.h"
#include "pleat/formats/glb_writer.h"
#include "pleat/formats/sequence_reader.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

// A triangle with two morph targets below two nodes.
class GltfSequenceTest : public testing::Test {
 protected:
  GltfSequenceTest() {
    gltf_.Add(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0}, 5126, "VEC3", 3);
    gltf_.Add(std::vector<float>{0, 0, 1, 0, 0, 1, 0, 0, 1}, 5126, "VEC3", 3);
    gltf_.root["asset"]["version"] = "2.0";
    gltf_.root["meshes"] = json::array(
        {{{"primitives",
           json::array({{{"attributes", {{"POSITION", 0}}},
                         {"targets", json::array({{{"POSITION", 1}}, {{"POSITION", 1}}})}}})}}});
    gltf_.root["nodes"] = json::array({{{"children", {1}}}, {{"mesh", 0}}});
    // A sparse target: only vertex 2 moves, by (5, 0, 0).
    const size_t indices = gltf_.Add(std::vector<uint16_t>{2}, 5123, "SCALAR", 1);
    const size_t values = gltf_.Add(std::vector<float>{5, 0, 0}, 5126, "VEC3", 1);
    gltf_.root["accessors"].push_back(
        {{"componentType", 5126},
         {"type", "VEC3"},
         {"count", 3},
         {"sparse",
          {{"count", 1},
           {"indices", {{"bufferView", indices}, {"componentType", 5123}}},
           {"values", {{"bufferView", values}}}}}});
    gltf_.root["meshes"][0]["primitives"][0]["targets"][1]["POSITION"] =
        gltf_.root["accessors"].size() - 1;
  }

  // Adds a channel; values as many as times times what the path has.
  void Animate(int node, const std::string& path, const std::vector<float>& times,
               const std::vector<float>& values, const std::string& interpolation = "LINEAR") {
    const size_t input = gltf_.Add(times, 5126, "SCALAR", static_cast<int>(times.size()));
    const int width = path == "weights" ? 1 : path == "rotation" ? 4 : 3;
    const size_t output = gltf_.Add(values, 5126,
                                    width == 1   ? "SCALAR"
                                    : width == 4 ? "VEC4"
                                                 : "VEC3",
                                    static_cast<int>(values.size()) / width);
    json& animation = gltf_.root["animations"][0];
    animation["channels"].push_back(
        {{"sampler", animation["samplers"].size()}, {"target", {{"node", node}, {"path", path}}}});
    animation["samplers"].push_back(
        {{"input", input}, {"output", output}, {"interpolation", interpolation}});
  }

  absl::StatusOr<MeshSequence> Read(std::optional<FrameRate> rate = {},
                                    const std::string& animation = {}) {
    report_ = {};
    EXPECT_THAT(WriteFile(folder_.File("a.glb"), PackFigureGltf(gltf_)), IsOk());
    return ReadSequence(folder_.File("a.glb"), {.frame_rate = rate, .animation = animation}, {},
                        &report_);
  }
  bool HasNote(const std::string& kind) const {
    return std::ranges::count(report_.notes, kind, &InputNote::kind) > 0;
  }

  FigureGltf gltf_;
  const TemporaryFolder folder_;
  InputReport report_;
};

TEST_F(GltfSequenceTest, WeightsMoveTheTargets) {
  Animate(1, "weights", {0, 0.5f, 1}, {0, 0, 1, 0, 0.5f, 2});
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence sequence, Read());
  ASSERT_EQ(sequence.num_frames(), 3);
  EXPECT_EQ(sequence.frame_rate(), (FrameRate{2, 1}));
  EXPECT_EQ(sequence.frame(1).col(0), Eigen::Vector3f(0, 0, 1));
  EXPECT_EQ(sequence.frame(2).col(1), Eigen::Vector3f(1, 0, 0.5f));
  EXPECT_EQ(sequence.frame(2).col(2), Eigen::Vector3f(10, 1, 0.5f));
}

TEST_F(GltfSequenceTest, NodesMoveTheMeshInAllInterpolations) {
  const float half = std::sqrt(0.5f);
  Animate(0, "rotation", {0, 1}, {0, 0, 0, 1, 0, 0, half, half});  // a quarter turn about z
  Animate(1, "translation", {0, 1}, {0, 0, 0, 4, 0, 0}, "STEP");
  Animate(1, "scale", {0, 1}, {0, 0, 0, 1, 1, 1, 0, 0, 0, 0, 0, 0, 3, 3, 3, 0, 0, 0},
          "CUBICSPLINE");
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence sequence, Read(FrameRate{4, 1}));
  ASSERT_EQ(sequence.num_frames(), 5);
  EXPECT_TRUE(HasNote("animation_sampled"));
  // At the middle: turned by 45 degrees, not yet moved, scaled by 2 (a cubic without slopes).
  const Eigen::Vector3f middle = sequence.frame(2).col(1);
  EXPECT_LT((middle - Eigen::Vector3f(2 * half, 2 * half, 0)).norm(), 1e-6);
  const Eigen::Vector3f end = sequence.frame(4).col(1);
  EXPECT_LT((end - Eigen::Vector3f(0, 7, 0)).norm(), 1e-5);
}

TEST_F(GltfSequenceTest, JointsMoveTheirVertices) {
  const SkinnedFigure figure = SmallFigure();
  gltf_ = MakeFigureGltf(figure);
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence still, Read());
  // The armature node, above the root, moves by one meter.
  Animate(0, "translation", {0, 1 / 24.f, 2 / 24.f}, {0, 0, 0, 1, 0, 0, 2, 0, 0});
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence sequence, Read());
  EXPECT_EQ(sequence.frame_rate(), (FrameRate{24, 1}));
  ASSERT_EQ(sequence.num_frames(), 3);
  for (int t = 0; t < 3; ++t) {
    const Eigen::Matrix3Xf moved =
        still.frame(0).colwise() + Eigen::Vector3f(static_cast<float>(t), 0, 0);
    EXPECT_LT((sequence.frame(t) - moved).cwiseAbs().maxCoeff(), 1e-5) << t;
  }
}

TEST_F(GltfSequenceTest, KeysAtFramesOfAUsualRateAreSampledThere) {
  Animate(1, "translation", {0, 3 / 24.f, 10 / 24.f}, {0, 0, 0, 3, 0, 0, 10, 0, 0});
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence sequence, Read());
  EXPECT_EQ(sequence.frame_rate(), (FrameRate{24, 1}));
  ASSERT_EQ(sequence.num_frames(), 11);
  EXPECT_NEAR(sequence.frame(7)(0, 0), 7, 1e-5);
  EXPECT_TRUE(HasNote("animation_sampled"));
}

TEST_F(GltfSequenceTest, KeysAtNoFramesAreAWarning) {
  Animate(1, "translation", {0, 0.0123f, 0.777f}, {0, 0, 0, 3, 0, 0, 10, 0, 0});
  EXPECT_THAT(Read(), IsOk());
  EXPECT_TRUE(HasNote("frame_rate_assumed"));
}

TEST_F(GltfSequenceTest, WhatIsWrongIsNamed) {
  Animate(1, "weights", {0, 0.5f, 1}, {0, 0, 1, 0, 0.5f, 2});
  const auto expect = [&](const std::function<void(json&)>& edit, const std::string& message) {
    const FigureGltf kept = gltf_;
    edit(gltf_.root);
    EXPECT_THAT(Read(), HasStatus(kInvalid, AllOf(HasSubstr("a.glb"), HasSubstr(message))));
    gltf_ = kept;
  };
  expect([](json& root) { root["animations"][0]["channels"][0]["target"]["node"] = 7; },
         "channel 0: GLB: its node is missing");
  expect([](json& root) { root["animations"][0]["channels"][0]["sampler"] = 7; }, "sampler");
  expect([](json& root) { root["animations"][0]["samplers"][0]["output"] = 0; }, "type SCALAR");
  expect([](json& root) { root["accessors"].back()["count"] = 5; }, "3 times and 5 values");
  expect([](json& root) { root["meshes"][0]["primitives"][0]["targets"][0]["POSITION"] = 3; },
         "a morph target has 1 vertices");
  gltf_.root["extensionsRequired"] = {"EXT_meshopt_compression"};
  EXPECT_THAT(Read(), HasStatus(kInvalid, HasSubstr("EXT_meshopt_compression")));
}

TEST_F(GltfSequenceTest, OfSeveralAnimationsTheFirstIsRead) {
  Animate(1, "weights", {0, 0.5f, 1}, {0, 0, 1, 0, 0.5f, 2});
  gltf_.root["animations"].push_back(gltf_.root["animations"][0]);
  EXPECT_THAT(Read(), IsOk());
  EXPECT_TRUE(HasNote("animations_left_out"));
}

TEST_F(GltfSequenceTest, AnAnimationIsChosenByItsNameOrItsNumber) {
  Animate(1, "weights", {0, 0.5f, 1}, {0, 0, 1, 0, 0.5f, 2});
  json walk = gltf_.root["animations"][0];
  gltf_.root.erase("animations");
  Animate(1, "weights", {0, 0.5f}, {0, 0, 1, 1});
  json jump = gltf_.root["animations"][0];
  json still = {{"name", "still"}, {"channels", json::array()}, {"samplers", json::array()}};
  walk["name"] = "walk";
  jump["name"] = "0";  // a name goes before a number
  gltf_.root["animations"] = {walk, jump, still};
  for (const auto& [wanted, num_frames] : {std::pair("walk", 3), {"1", 2}, {"0", 2}}) {
    PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence sequence, Read({}, wanted));
    EXPECT_EQ(sequence.num_frames(), num_frames) << wanted;
    EXPECT_FALSE(HasNote("animations_left_out"));
  }
  EXPECT_THAT(Read({}, "run"),
              HasStatus(absl::StatusCode::kNotFound,
                        AllOf(HasSubstr("no animation 'run' in 3"), HasSubstr("0 'walk', 1 '0'"))));
  EXPECT_THAT(Read({}, "3"), HasStatus(absl::StatusCode::kNotFound, HasSubstr("'3'")));
  EXPECT_THAT(Read({}, "still"), HasStatus(kInvalid, HasSubstr("moves nothing")));
  gltf_.root.erase("animations");
  EXPECT_THAT(Read({}, "walk"),
              HasStatus(absl::StatusCode::kNotFound, HasSubstr("in 0 animations")));
}

TEST(GltfSequence, DamagedFilesFailCleanly) {
  const std::string bytes = EncodeGlb(PaintedBox(2)).value();
  ReadSequenceOptions options;
  options.limits.max_vertices = 1000;
  options.limits.max_frames = 100;
  const Progress progress;
  const auto read = [&](const std::string& damaged) {
    InputReport report;
    const auto sequence = DecodeGlbAnimation(damaged, "a.glb", {options, progress, &report});
    if (sequence.ok() && *sequence) {
      EXPECT_GT((*sequence)->num_frames(), 0);
    }
  };
  for (size_t length = 0; length < bytes.size(); length += 7) read(bytes.substr(0, length));
  for (size_t i = 0; i < bytes.size(); ++i) {
    for (const int flip : {0x01, 0x10, 0x80}) {
      std::string damaged = bytes;
      damaged[i] = static_cast<char>(damaged[i] ^ flip);
      read(damaged);
    }
  }
}

}  // namespace
}  // namespace pleat
