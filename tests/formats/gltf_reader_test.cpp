// glTF files as meshes: what glTF 2.0 says about primitives, nodes and skins.
#include "pleat/formats/gltf_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <functional>

#include "figure_glb.h"
#include "pleat/base/file.h"
#include "pleat/formats/sequence_reader.h"
#include "support/hostile_bytes.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

// Two squares of one unit side by side in the plane z = 0: vertices 0 to 5 in two rows of three.
class GltfReaderTest : public testing::Test {
 protected:
  GltfReaderTest() {
    std::vector<float> positions;
    for (const float y : {0.f, 1.f}) {
      for (const float x : {0.f, 1.f, 2.f}) positions.insert(positions.end(), {x, y, 0});
    }
    positions_.resize(3, 6);
    for (int v = 0; v < 6; ++v) positions_.col(v) << positions[3 * v], positions[3 * v + 1], 0;
    gltf_.root["asset"]["version"] = "2.0";
    gltf_.Add(positions, 5126, "VEC3", 6);
    gltf_.Add(indices_, 5121, "SCALAR", static_cast<int>(indices_.size()));
    gltf_.root["meshes"] = {
        {{"primitives", {{{"attributes", {{"POSITION", 0}}}, {"indices", 1}}}}}};
    gltf_.root["nodes"] = {{{"mesh", 0}}};
  }

  json& primitive() { return gltf_.root["meshes"][0]["primitives"][0]; }
  absl::StatusOr<MeshFile> Decode() const { return DecodeGlb(PackFigureGltf(gltf_), "a.glb"); }
  // Decodes a copy after an edit, which must be refused.
  absl::Status Fault(const std::function<void(json&)>& edit) const {
    FigureGltf changed = gltf_;
    edit(changed.root);
    return DecodeGlb(PackFigureGltf(changed), "a.glb").status();
  }

  const std::vector<uint8_t> indices_ = {0, 1, 4, 0, 4, 3, 1, 2, 5, 1, 5, 4};
  Eigen::Matrix3Xf positions_;
  FigureGltf gltf_;
};

// The sum of the triangles' areas as vectors: 2 in +z for the two squares, wound to the viewer.
Eigen::Vector3f AreaVector(const MeshFile& mesh) {
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  for (const auto& triangle : mesh.topology.triangles().colwise()) {
    const Eigen::Vector3f a = mesh.positions.col(triangle[0]);
    sum += (mesh.positions.col(triangle[1]) - a).cross(mesh.positions.col(triangle[2]) - a) / 2;
  }
  return sum;
}

TEST_F(GltfReaderTest, PositionsAndIndicesOfAllTypesAreThoseOfTheFile) {
  gltf_.Add(std::vector<uint16_t>(indices_.begin(), indices_.end()), 5123, "SCALAR", 12);
  gltf_.Add(std::vector<uint32_t>(indices_.begin(), indices_.end()), 5125, "SCALAR", 12);
  for (const int accessor : {1, 2, 3}) {
    primitive()["indices"] = accessor;
    PLEAT_ASSERT_OK_AND_ASSIGN(const MeshFile mesh, Decode());
    EXPECT_EQ(mesh.positions, positions_);
    EXPECT_EQ(mesh.topology.corner_vertices(),
              std::vector<int32_t>(indices_.begin(), indices_.end()));
    EXPECT_EQ(mesh.topology.num_faces(), 4);
    EXPECT_TRUE(mesh.notes.empty());
    EXPECT_TRUE(mesh.appearance.texcoords.empty());
    EXPECT_TRUE(mesh.appearance.face_materials.empty());
  }
}

TEST_F(GltfReaderTest, WithoutIndicesEveryThreeVerticesAreATriangle) {
  primitive().erase("indices");
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshFile mesh, Decode());
  EXPECT_THAT(mesh.topology.corner_vertices(), ElementsAre(0, 1, 2, 3, 4, 5));
  gltf_.root["accessors"][0]["count"] = 5;
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshFile cut, Decode());
  EXPECT_THAT(cut.topology.corner_vertices(), ElementsAre(0, 1, 2));
  EXPECT_EQ(cut.positions.cols(), 5);
  ASSERT_EQ(cut.notes.size(), 1u);
  EXPECT_EQ(cut.notes[0].kind, "faces_left_out");
}

TEST_F(GltfReaderTest, StripsAndFansAreTrianglesWoundAlike) {
  // Up and down the two squares; 4 comes twice, which ends one strip and begins the next.
  const std::vector<uint8_t> strip = {3, 0, 4, 1, 5, 2, 2, 2};
  const std::vector<uint8_t> fan = {1, 2, 5, 4, 3, 0};
  const size_t strip_at = gltf_.Add(strip, 5121, "SCALAR", 8);
  const size_t fan_at = gltf_.Add(fan, 5121, "SCALAR", 6);
  for (const auto& [mode, accessor] :
       std::vector<std::pair<int, size_t>>{{5, strip_at}, {6, fan_at}}) {
    primitive()["mode"] = mode;
    primitive()["indices"] = accessor;
    PLEAT_ASSERT_OK_AND_ASSIGN(const MeshFile mesh, Decode());
    EXPECT_EQ(mesh.topology.num_faces(), 4) << mode;
    EXPECT_TRUE(AreaVector(mesh).isApprox(Eigen::Vector3f(0, 0, 2))) << mode;
    for (int f = 0; f < 4; ++f) {  // none turned around, which the sum would hide
      const MeshFile one = {
          *Topology::FromTriangles(6, mesh.topology.triangles().col(f)), mesh.positions, {}};
      EXPECT_GT(AreaVector(one).z(), .4f) << mode << " " << f;
    }
  }
}

TEST_F(GltfReaderTest, NodesPlaceTheMeshAndAMirrorKeepsTheOutside) {
  gltf_.root["nodes"] = {
      {{"mesh", 0}, {"translation", {1, 0, 0}}},
      {{"children", {0}}, {"rotation", {0, 0, std::sqrt(.5), std::sqrt(.5)}}, {"scale", {2, 2, 2}}},
      {{"mesh", 0}, {"matrix", {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 5, 1}}}};
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshFile mesh, Decode());
  ASSERT_EQ(mesh.positions.cols(), 12);
  for (int v = 0; v < 6; ++v) {
    const Eigen::Vector3f p = positions_.col(v);
    // First moved by one along x, then scaled by two and turned by a quarter about z.
    EXPECT_TRUE(
        mesh.positions.col(v).isApprox(Eigen::Vector3f(-2 * p.y(), 2 * (p.x() + 1), 0), 1e-6f));
    EXPECT_EQ(mesh.positions.col(6 + v), Eigen::Vector3f(-p.x(), p.y(), 5));
  }
  EXPECT_TRUE(AreaVector(mesh).isApprox(Eigen::Vector3f(0, 0, 4 * 2 + 2)));
}

TEST_F(GltfReaderTest, OnlyTheDefaultSceneIsShown) {
  gltf_.root["nodes"] = {{{"mesh", 0}}, {{"children", {2}}}, {{"mesh", 0}}};
  gltf_.root["scenes"] = {{{"nodes", {0, 1}}}, {{"nodes", {1}}}};
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshFile both, Decode());
  EXPECT_EQ(both.positions.cols(), 12);
  gltf_.root["scene"] = 1;
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshFile one, Decode());
  EXPECT_EQ(one.positions.cols(), 6);
  for (const json& roots : {json{0, 0}, json{2}, json{7}, json{"0"}}) {
    EXPECT_THAT(Fault([&](json& r) { r["scenes"][1]["nodes"] = roots; }),
                HasStatus(kInvalid, HasSubstr("node of the scene")));
  }
  EXPECT_THAT(Fault([](json& r) { r["scene"] = 2; }), HasStatus(kInvalid, HasSubstr("scene")));
}

TEST_F(GltfReaderTest, PiecesOfOneAccessorShareItsVerticesAndKeepTheirMaterials) {
  const size_t uv =
      gltf_.Add(std::vector<float>{0, .25f, 0, 0, 0, 0, 0, 0, 0, 0, 1, 1}, 5126, "VEC2", 6);
  gltf_.root["materials"] = {{{"name", "skin"}}, {{"name", "never used"}}, json::object()};
  json& pieces = gltf_.root["meshes"][0]["primitives"];
  pieces[0]["material"] = 0;
  pieces.push_back(pieces[0]);
  pieces[1]["material"] = 2;
  pieces.push_back(pieces[0]);
  pieces[2]["attributes"]["TEXCOORD_0"] = uv;
  pieces[2].erase("material");
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshFile mesh, Decode());
  EXPECT_EQ(mesh.positions.cols(), 12);  // the third has other attributes
  EXPECT_EQ(mesh.topology.num_faces(), 12);
  EXPECT_THAT(mesh.appearance.material_names, ElementsAre("skin", "material_2"));
  EXPECT_THAT(mesh.appearance.face_materials, ElementsAre(0, 0, 0, 0, 1, 1, 1, 1, -1, -1, -1, -1));
  EXPECT_THAT(CheckAppearance(mesh.appearance, mesh.topology), IsOk());
  ASSERT_EQ(mesh.appearance.texcoords.size(), 6u);
  EXPECT_EQ(mesh.appearance.texcoords[0], Eigen::Vector2f(0, .75f));  // v points up, as in OBJ
  EXPECT_EQ(mesh.appearance.texcoords[5], Eigen::Vector2f(1, 0));
  EXPECT_EQ(mesh.appearance.corner_texcoords[23], -1);
  EXPECT_EQ(mesh.appearance.corner_texcoords[24 + 8], 5);  // the corner of vertex 5
}

TEST_F(GltfReaderTest, SkinnedMeshesArePosedByTheirJointsAlone) {
  const SkinnedFigure figure = SmallFigure();
  gltf_ = MakeFigureGltf(figure);
  gltf_.root["nodes"].back()["translation"] = {7, 8, 9};  // does not count
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshFile rest, Decode());
  const Eigen::Matrix3Xf expected = figure.rig.rest_positions.cast<float>();
  ASSERT_EQ(rest.positions.cols(), expected.cols());
  EXPECT_LT((rest.positions - expected).cwiseAbs().maxCoeff(), 1e-5);

  // A joint that is moved takes each vertex along by the weights of what hangs on it.
  const Skeleton& skeleton = figure.rig.skeleton;
  const int moved = skeleton.FindJoint("leftUpperArm");
  ASSERT_GE(moved, 1);
  const auto hangs_on_it = [&](int joint) {
    for (; joint >= 0; joint = skeleton.parent(joint)) {
      if (joint == moved) return true;
    }
    return false;
  };
  json& move = gltf_.root["nodes"][static_cast<size_t>(moved) + 1]["translation"];
  move[1] = move[1].get<double>() + 20;  // centimeters
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshFile posed, Decode());
  float largest = 0;
  for (int v = 0; v < expected.cols(); ++v) {
    const VertexInfluences& influences = figure.rig.weights.vertex(v);
    float share = 0;
    for (int k = 0; k < kMaxInfluences; ++k) {
      if (influences.weights[k] > 0 && hangs_on_it(skeleton.parent(influences.bones[k]))) {
        share += influences.weights[k];
      }
    }
    EXPECT_NEAR(posed.positions(1, v) - expected(1, v), .2f * share, 1e-5);
    largest = std::max(largest, share);
  }
  EXPECT_GT(largest, .9f);
}

TEST_F(GltfReaderTest, WhatIsLeftOutIsSaid) {
  gltf_.root["animations"] = {json::object()};
  primitive()["targets"] = {{{"POSITION", 0}}};
  primitive()["attributes"]["COLOR_0"] = 0;
  primitive()["attributes"]["NORMAL"] = 0;
  json points = primitive();
  points["mode"] = 0;
  gltf_.root["meshes"][0]["primitives"].push_back(points);
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshFile mesh, Decode());
  ASSERT_EQ(mesh.notes.size(), 2u);
  EXPECT_EQ(mesh.notes[0].text, "not kept: COLOR_0, lines and points, morph targets");
  EXPECT_EQ(mesh.notes[1].kind, "animation_not_read");
  EXPECT_EQ(mesh.notes[1].severity, NoteSeverity::kWarning);
}

TEST_F(GltfReaderTest, FaultsAreNamedWithTheFile) {
  for (const char* name : {"EXT_meshopt_compression", "KHR_draco_mesh_compression"}) {
    EXPECT_THAT(Fault([&](json& r) { r["extensionsRequired"] = {name}; }),
                HasStatus(kInvalid, AllOf(HasSubstr("a.glb: "), HasSubstr(name))));
  }
  EXPECT_THAT(Fault([](json& r) { r["accessors"][0]["count"] = 5; }),
              HasStatus(kInvalid, HasSubstr("index 8 of its mesh names vertex 5 of 5")));
  EXPECT_THAT(Fault([](json& r) { r["nodes"][0].erase("mesh"); }),
              HasStatus(kInvalid, HasSubstr("shows no triangles")));
  EXPECT_THAT(Fault([](json& r) { r["meshes"][0]["primitives"][0]["mode"] = 7; }),
              HasStatus(kInvalid, HasSubstr("unknown mode")));
  EXPECT_THAT(Fault([](json& r) { r["meshes"][0]["primitives"][0]["attributes"].clear(); }),
              HasStatus(kInvalid, HasSubstr("no POSITION")));
  EXPECT_THAT(Fault([](json& r) { r["nodes"][0]["skin"] = 0; }),
              HasStatus(kInvalid, HasSubstr("skin of a node is missing")));
  EXPECT_THAT(Fault([](json& r) { r["accessors"][1].erase("bufferView"); }),
              HasStatus(kInvalid, HasSubstr("compress")));
}

TEST_F(GltfReaderTest, WhatUnfoldsBeyondTheLimitsIsRefused) {
  const std::string bytes = PackFigureGltf(gltf_);
  EXPECT_THAT(DecodeGlb(bytes, "a.glb", {.max_vertices = 5}),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("more than 5 vertices")));
  EXPECT_THAT(DecodeGlb(bytes, "a.glb", {.max_faces = 3}),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("more than 3 triangles")));
  EXPECT_THAT(DecodeGlb(bytes, "a.glb", {.max_document_bytes = 50}),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("of JSON")));
  // A thousand nodes of a mesh of five thousand pieces without a triangle.
  const json piece = {{"attributes", {{"POSITION", 0}}}, {"mode", 0}};
  for (int i = 0; i < 5000; ++i) gltf_.root["meshes"][0]["primitives"].push_back(piece);
  for (int i = 0; i < 1000; ++i) gltf_.root["nodes"].push_back({{"mesh", 0}});
  EXPECT_THAT(Decode(), HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("pieces")));
}

TEST_F(GltfReaderTest, EitherFormIsAnInputOfOneFrame) {
  const TemporaryFolder folder;
  ASSERT_THAT(WriteFile(folder.File("binary/a.glb"), PackFigureGltf(gltf_)), IsOk());
  json root = gltf_.root;
  root["buffers"] = {{{"uri", "a.bin"}, {"byteLength", gltf_.binary.size()}}};
  ASSERT_THAT(WriteFile(folder.File("text/a.gltf"), root.dump()), IsOk());
  ASSERT_THAT(WriteFile(folder.File("text/a.bin"), gltf_.binary), IsOk());
  for (const char* input : {"binary/a.glb", "text/a.gltf", "binary", "text", "text/*.gltf"}) {
    PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence sequence, ReadSequence(folder.File(input)));
    ASSERT_EQ(sequence.num_frames(), 1) << input;
    EXPECT_EQ(sequence.frame(0), positions_) << input;
  }
  // Beside frames of another kind it is no frame.
  ASSERT_THAT(WriteFile(folder.File("text/b.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), IsOk());
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence obj, ReadSequence(folder.File("text")));
  EXPECT_EQ(obj.frame(0).cols(), 3);
  ASSERT_THAT(WriteFile(folder.File("text/a.gltf"), "{}"), IsOk());
  EXPECT_THAT(ReadGltf(folder.File("text/a.gltf")),
              HasStatus(kInvalid, AllOf(HasSubstr("a.gltf"), HasSubstr("no triangles"))));
  ASSERT_THAT(WriteFile(folder.File("bad.glb"), "glass"), IsOk());
  EXPECT_THAT(ReadGltf(folder.File("bad.glb")),
              HasStatus(kInvalid, AllOf(HasSubstr("bad.glb"), HasSubstr("not a binary glTF"))));
}

TEST_F(GltfReaderTest, DamagedBytesNeverCrash) {
  const std::string bytes = PackFigureGltf(gltf_);
  ForEachTruncation(bytes, [](const std::string& cut) {
    EXPECT_FALSE(DecodeGlb(cut, "a.glb").ok()) << cut.size();
  });
  ForEachCorruption(bytes, [](const std::string& damaged) {
    const absl::StatusOr<MeshFile> mesh = DecodeGlb(damaged, "a.glb");
    if (!mesh.ok()) return;
    EXPECT_EQ(mesh->positions.cols(), mesh->topology.num_vertices());
  });
}

}  // namespace
}  // namespace pleat
