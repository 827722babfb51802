// Skins of GLB files: what glTF 2.0 says about the rest pose, about accessors and about skins.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "figure_glb.h"
#include "pleat/formats/rig_file.h"
#include "support/hostile_bytes.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;

std::string Edited(const SkinnedFigure& figure, const std::function<void(json&)>& edit) {
  FigureGltf gltf = MakeFigureGltf(figure);
  edit(gltf.root);
  return PackFigureGltf(std::move(gltf));
}

// Expects the rig of the unedited figure.
void ExpectSameRig(const FigureGltf& gltf, double tolerance = 1e-4) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const RigFile expected,
                             DecodeRigGlb(PackFigureGltf(MakeFigureGltf(SmallFigure()))));
  PLEAT_ASSERT_OK_AND_ASSIGN(const RigFile file, DecodeRigGlb(PackFigureGltf(gltf)));
  ASSERT_EQ(file.positions.cols(), expected.positions.cols());
  EXPECT_LT((file.positions - expected.positions).cwiseAbs().maxCoeff(), tolerance);
  EXPECT_LT((file.skeleton.RestPositions() - expected.skeleton.RestPositions()).norm(), tolerance);
  for (size_t v = 0; v < expected.influences.size(); ++v) {
    ASSERT_EQ(file.influences[v].size(), expected.influences[v].size()) << v;
    for (size_t k = 0; k < expected.influences[v].size(); ++k) {
      EXPECT_EQ(file.influences[v][k].joint, expected.influences[v][k].joint);
      EXPECT_NEAR(file.influences[v][k].weight, expected.influences[v][k].weight, .005);
    }
  }
}

// The floats of accessor `index` of a figure that was not edited.
std::vector<float> Floats(const FigureGltf& gltf, int index) {
  const json& view = gltf.root["bufferViews"][index];
  std::vector<float> values(view["byteLength"].get<size_t>() / sizeof(float));
  gltf.binary.copy(reinterpret_cast<char*>(values.data()), view["byteLength"].get<size_t>(),
                   view["byteOffset"].get<size_t>());
  return values;
}

TEST(RigGlb, PosedNodesAndTheTransformOfTheMeshNodeChangeNothing) {
  FigureGltf gltf = MakeFigureGltf(SmallFigure());
  for (json& node : gltf.root["nodes"]) {
    node["rotation"] = {.6, 0, 0, .8};
    node["translation"] = {3, 1, -2};
    node["scale"] = {100, 100, 100};
  }
  ExpectSameRig(gltf);
}

// As exporters write an armature in centimeters above a mesh in meters: its scale is in every
// inverse bind matrix.
TEST(RigGlb, ScalesOfAnArmatureInTheBindMatricesLeaveTheJointsInPlace) {
  FigureGltf gltf = MakeFigureGltf(SmallFigure());
  gltf.root["nodes"][0]["scale"] = {100, 100, 100};
  std::vector<float> binds = Floats(gltf, 3);
  for (size_t i = 0; i < binds.size(); ++i) binds[i] *= i % 16 == 15 ? 1.f : .01f;
  gltf.root["skins"][0]["inverseBindMatrices"] =
      gltf.Add(binds, 5126, "MAT4", static_cast<int>(binds.size() / 16));
  ExpectSameRig(gltf);
}

TEST(RigGlb, WithoutInverseBindMatricesTheNodesGiveTheRestPose) {
  FigureGltf gltf = MakeFigureGltf(SmallFigure());
  gltf.root["nodes"][0]["scale"] = {1, 1, 1};
  gltf.root["skins"][0].erase("inverseBindMatrices");
  ExpectSameRig(gltf);
  gltf.root["nodes"][1]["translation"] = {0, 0, 0};
  PLEAT_ASSERT_OK_AND_ASSIGN(const RigFile moved, DecodeRigGlb(PackFigureGltf(gltf)));
  EXPECT_EQ(moved.skeleton.rest_position(0), Eigen::Vector3d::Zero());
}

TEST(RigGlb, OfTwoSkinsOneIsChosenByNameOrNumber) {
  const std::string bytes = Edited(SmallFigure(), [](json& r) {
    r["skins"][0]["name"] = "body";
    r["skins"].push_back(r["skins"][0]);
    r["skins"][1]["name"] = "hair";
    r["nodes"].back()["skin"] = 1;
  });
  EXPECT_THAT(DecodeRigGlb(bytes),
              HasStatus(kInvalid, AllOf(HasSubstr("0 'body', 1 'hair'"), HasSubstr("--skin"))));
  EXPECT_THAT(DecodeRigGlb(bytes, {}, "hair"), IsOk());
  EXPECT_THAT(DecodeRigGlb(bytes, {}, "1"), IsOk());
  EXPECT_THAT(DecodeRigGlb(bytes, {}, "body"), HasStatus(kInvalid, HasSubstr("no mesh")));
  for (const char* wrong : {"2", "-1", "tail"}) {
    EXPECT_THAT(DecodeRigGlb(bytes, {}, wrong), HasStatus(kInvalid, HasSubstr("'hair'"))) << wrong;
  }
  EXPECT_THAT(DecodeRigGlb(PackFigureGltf(MakeFigureGltf(SmallFigure())), {}, "tail"),
              HasStatus(kInvalid, HasSubstr("the file has 1 skin: 0 ''")));
}

TEST(RigGlb, InterleavedVerticesAreRead) {
  FigureGltf gltf = MakeFigureGltf(SmallFigure());
  const std::vector<float> positions = Floats(gltf, 0), weights = Floats(gltf, 2);
  const int num_vertices = static_cast<int>(positions.size() / 3);
  std::vector<float> both;
  for (int v = 0; v < num_vertices; ++v) {
    both.insert(both.end(), &positions[3 * v], &positions[3 * v] + 3);
    both.insert(both.end(), &weights[4 * v], &weights[4 * v] + 4);
  }
  const size_t added = gltf.Add(both, 5126, "VEC3", num_vertices);
  gltf.root["bufferViews"][added]["byteStride"] = 28;
  for (const int accessor : {0, 2}) gltf.root["accessors"][accessor]["bufferView"] = added;
  gltf.root["accessors"][2]["byteOffset"] = 12;
  ExpectSameRig(gltf);
}

TEST(RigGlb, SparseAccessorsReplaceElementsOfTheirBaseOrOfZeros) {
  for (const int index_type : {5121, 5123, 5125}) {
    for (const bool has_base : {true, false}) {
      FigureGltf gltf = MakeFigureGltf(SmallFigure());
      std::vector<float> values = Floats(gltf, 0);
      const int num_vertices = static_cast<int>(values.size() / 3);
      std::vector<uint8_t> indices8;
      std::vector<uint16_t> indices16;
      std::vector<uint32_t> indices32;
      const int step = has_base ? 2 : 1;
      std::vector<float> replaced, spoiled = values;
      for (int v = 0; v < num_vertices; v += step) {
        indices8.push_back(static_cast<uint8_t>(v));
        indices16.push_back(static_cast<uint16_t>(v));
        indices32.push_back(static_cast<uint32_t>(v));
        for (int k = 0; k < 3; ++k) {
          replaced.push_back(values[3 * v + k]);
          spoiled[3 * v + k] = 7;
        }
      }
      const int count = static_cast<int>(indices8.size());
      const size_t indices = index_type == 5121   ? gltf.Add(indices8, 5121, "SCALAR", count)
                             : index_type == 5123 ? gltf.Add(indices16, 5123, "SCALAR", count)
                                                  : gltf.Add(indices32, 5125, "SCALAR", count);
      const size_t base = gltf.Add(spoiled, 5126, "VEC3", num_vertices);
      const size_t list = gltf.Add(replaced, 5126, "VEC3", count);
      gltf.root["accessors"][0]["sparse"] = {
          {"count", count},
          {"indices", {{"bufferView", indices}, {"componentType", index_type}}},
          {"values", {{"bufferView", list}}}};
      gltf.root["accessors"][0]["bufferView"] = base;
      if (!has_base) gltf.root["accessors"][0].erase("bufferView");
      ExpectSameRig(gltf);
    }
  }
}

template <typename T>
FigureGltf WithWholeWeights(int component) {
  FigureGltf gltf = MakeFigureGltf(SmallFigure());
  std::vector<T> whole;
  for (const float weight : Floats(gltf, 2)) {
    const auto rounded =
        static_cast<T>(std::lround(weight * static_cast<float>(std::numeric_limits<T>::max())));
    whole.push_back(weight > 0 ? std::max<T>(rounded, 1) : T{0});
  }
  const size_t added = gltf.Add(whole, component, "VEC4", static_cast<int>(whole.size() / 4));
  gltf.root["accessors"][added]["normalized"] = true;
  gltf.root["meshes"][0]["primitives"][0]["attributes"]["WEIGHTS_0"] = added;
  return gltf;
}

TEST(RigGlb, NormalizedWeightsAreFractions) {
  ExpectSameRig(WithWholeWeights<uint8_t>(5121));
  ExpectSameRig(WithWholeWeights<uint16_t>(5123));
}

// The second set holds half of every weight again, for the same joints in another order.
TEST(RigGlb, FurtherSetsOfInfluencesAreReadAndWhatIsLeftOutIsSaid) {
  const SkinnedFigure figure = SmallFigure();
  FigureGltf gltf = MakeFigureGltf(figure);
  const std::vector<float> weights = Floats(gltf, 2);
  const int num_vertices = static_cast<int>(weights.size() / 4);
  std::vector<uint8_t> joints;
  std::vector<float> others;
  for (int v = 0; v < num_vertices; ++v) {
    joints.insert(joints.end(), {0, 1, 2, 3});
    others.insert(others.end(), {.01f, .02f, 0, .03f});
  }
  json& attributes = gltf.root["meshes"][0]["primitives"][0]["attributes"];
  attributes["JOINTS_1"] = gltf.Add(joints, 5121, "VEC4", num_vertices);
  EXPECT_THAT(DecodeRigGlb(PackFigureGltf(gltf)),
              HasStatus(kInvalid, HasSubstr("JOINTS_1 and WEIGHTS_1")));
  attributes["WEIGHTS_1"] = gltf.Add(others, 5126, "VEC4", num_vertices);
  PLEAT_ASSERT_OK_AND_ASSIGN(const RigFile plain,
                             DecodeRigGlb(PackFigureGltf(MakeFigureGltf(figure))));
  PLEAT_ASSERT_OK_AND_ASSIGN(const RigFile file, DecodeRigGlb(PackFigureGltf(gltf)));
  const int num_joints = figure.rig.skeleton.num_joints();
  size_t num_cut = 0;
  for (int v = 0; v < num_vertices; ++v) {
    const std::vector<JointInfluence>& influences = file.influences[v];
    const size_t num_before = plain.influences[v].size();
    ASSERT_EQ(influences.size(), num_before + 3) << v;
    const JointInfluence& last = influences.back();  // the skin lists the joints in reverse
    EXPECT_EQ(file.skeleton.joint(last.joint).name, figure.rig.skeleton.joint(num_joints - 4).name);
    EXPECT_FLOAT_EQ(static_cast<float>(last.weight), .03f);
    num_cut += num_before + 6 > kMaxInfluences;
  }
  std::vector<InputNote> notes;
  ASSERT_THAT(ResolveRig(file, StillClip(figure), &notes), IsOk());
  const auto left_out = [&notes] {
    return std::ranges::find(notes, "influences_left_out", &InputNote::kind);
  };
  EXPECT_EQ(left_out(), notes.end()) << "seven influences are kept";
  // Three more are too many for some vertices.
  ASSERT_GT(num_cut, 0u);
  attributes["JOINTS_2"] = attributes["JOINTS_1"];
  attributes["WEIGHTS_2"] = attributes["WEIGHTS_1"];
  PLEAT_ASSERT_OK_AND_ASSIGN(const RigFile more, DecodeRigGlb(PackFigureGltf(gltf)));
  ASSERT_THAT(ResolveRig(more, StillClip(figure), &notes), IsOk());
  ASSERT_NE(left_out(), notes.end());
  EXPECT_THAT(left_out()->text, HasSubstr(std::to_string(num_cut) + " of "));
  attributes["JOINTS_2"] = attributes["JOINTS_3"] = attributes["JOINTS_4"] = attributes["JOINTS_1"];
  attributes["WEIGHTS_2"] = attributes["WEIGHTS_3"] = attributes["WEIGHTS_4"] =
      attributes["WEIGHTS_1"];
  EXPECT_THAT(DecodeRigGlb(PackFigureGltf(gltf)),
              HasStatus(kInvalid, HasSubstr("more than 16 influences")));
}

// Without its root, the figure has three: both legs and the trunk.
TEST(RigGlb, SeveralRootsGetAJointAboveThem) {
  const SkinnedFigure figure = SmallFigure();
  const Skeleton& skeleton = figure.rig.skeleton;
  ASSERT_GT(skeleton.children(0).size(), 1u);
  FigureGltf gltf = MakeFigureGltf(figure);
  const int num_joints = skeleton.num_joints();
  json& joints = gltf.root["skins"][0]["joints"];
  joints.erase(joints.size() - 1);  // the root comes last
  for (json& node : gltf.root["nodes"]) {
    if (node["name"] == skeleton.joint(0).name) node["name"] = "Armature";
  }
  // What moved with the root moves with its first child, which comes last now.
  std::vector<uint16_t> influences;
  for (const auto& vertex : figure.rig.weights.influences()) {
    for (int k = 0; k < 4; ++k) {
      const int parent = vertex.weights[k] > 0 ? skeleton.parent(vertex.bones[k]) : 1;
      influences.push_back(static_cast<uint16_t>(num_joints - 1 - std::max(parent, 1)));
    }
  }
  gltf.root["meshes"][0]["primitives"][0]["attributes"]["JOINTS_0"] =
      gltf.Add(influences, 5123, "VEC4", static_cast<int>(influences.size() / 4));
  PLEAT_ASSERT_OK_AND_ASSIGN(const RigFile file, DecodeRigGlb(PackFigureGltf(gltf)));
  ASSERT_EQ(file.skeleton.num_joints(), num_joints);
  EXPECT_EQ(file.skeleton.joint(0).name, "Armature");
  EXPECT_EQ(file.skeleton.children(0).size(), skeleton.children(0).size());
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const int child : skeleton.children(0)) {
    middle += 100 * skeleton.rest_position(child) / double(skeleton.children(0).size());
    const int found = file.skeleton.FindJoint(skeleton.joint(child).name);
    ASSERT_GE(found, 1);
    EXPECT_EQ(file.skeleton.parent(found), 0);
    EXPECT_LT((file.skeleton.rest_position(found) - 100 * skeleton.rest_position(child)).norm(),
              1e-3);
  }
  EXPECT_LT((file.skeleton.rest_position(0) - middle).norm(), 1e-3);
  std::vector<InputNote> notes;
  EXPECT_THAT(ResolveRig(file, StillClip(figure), &notes), IsOk());
  ASSERT_FALSE(notes.empty());
  EXPECT_EQ(notes[0].kind, "roots_joined");
  EXPECT_THAT(notes[0].text, AllOf(HasSubstr("roots"), HasSubstr("'Armature'")));
}

TEST(RigGlb, AMeshInAnotherUnitAndPlaceIsAlignedAndSaid) {
  const SkinnedFigure figure = SmallFigure();
  PLEAT_ASSERT_OK_AND_ASSIGN(const RigFile plain,
                             DecodeRigGlb(PackFigureGltf(MakeFigureGltf(figure))));
  PLEAT_ASSERT_OK_AND_ASSIGN(const UserRig expected, ResolveRig(plain, StillClip(figure)));
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(2, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  for (const double unit : {1., 100., .01, .0254, 1 / .0254}) {
    for (const int num_split : {0, 40}) {  // vertices that an exporter doubled at seams
      RigFile file = plain;
      file.shown_from_mesh.setIdentity();
      const auto move = [&](const Eigen::Matrix3Xd& points) -> Eigen::Matrix3Xd {
        return ((turn * points) * (.01 / unit)).colwise() + Eigen::Vector3d(3, -1, 2) / unit;
      };
      file.skeleton = plain.skeleton.WithRestPositions(move(plain.skeleton.RestPositions()));
      file.positions.resize(3, plain.positions.cols() + num_split);
      file.positions << move(plain.positions), move(plain.positions.leftCols(num_split));
      for (int v = 0; v < num_split; ++v) file.influences.push_back(plain.influences[v]);
      std::vector<InputNote> notes;
      PLEAT_ASSERT_OK_AND_ASSIGN(const UserRig rig, ResolveRig(file, StillClip(figure), &notes));
      EXPECT_LT((rig.skeleton.RestPositions() - expected.skeleton.RestPositions()).norm(), 1e-3);
      EXPECT_TRUE(rig.weights->ToDense().isApprox(expected.weights->ToDense(), 1e-5));
      ASSERT_EQ(notes.size(), 1u);
      EXPECT_EQ(notes[0].kind, "rig_aligned");
      EXPECT_THAT(notes[0].text, HasSubstr("turned by 114.6 degrees"));
    }
  }
}

// A mesh with a symmetry could be laid on the clip with left and right exchanged.
TEST(RigGlb, AMeshThatFitsInSeveralWaysIsRefused) {
  RigFile file;
  file.skeleton =
      *Skeleton::Create({{"a", -1, Eigen::Vector3d(9, 0, 0)}, {"b", 0, Eigen::Vector3d(9, 1, 0)}});
  Eigen::Matrix3Xd corners(3, 8);
  for (int c = 0; c < 8; ++c) corners.col(c) << c % 2, 2 * (c / 2 % 2), 3 * (c / 4);
  file.positions.resize(3, 9);
  file.positions << corners, corners.col(0);
  file.positions.row(0).array() += 9;
  file.influences.assign(9, {{0, 1.}});
  const MeshSequence clip = *MeshSequence::Create(
      *Topology::Create(8, {0, 1, 2, 3, 4, 5, 6, 7}, {4, 4}), {corners.cast<float>()});
  EXPECT_THAT(ResolveRig(file, clip), HasStatus(kInvalid, HasSubstr("in several ways")));
}

TEST(RigGlb, GivesNamesHierarchyPlacesAndWeights) {
  const SkinnedFigure figure = SmallFigure();
  const Skeleton& skeleton = figure.rig.skeleton;
  PLEAT_ASSERT_OK_AND_ASSIGN(const RigFile file,
                             DecodeRigGlb(PackFigureGltf(MakeFigureGltf(figure))));
  ASSERT_EQ(file.skeleton.num_joints(), skeleton.num_joints());
  for (const Joint& joint : skeleton.joints()) {
    const int j = file.skeleton.FindJoint(joint.name);
    ASSERT_GE(j, 0) << joint.name;
    EXPECT_LT((.01 * file.skeleton.rest_position(j) - joint.rest_position).norm(), 1e-5);
    if (joint.parent >= 0) {
      EXPECT_EQ(file.skeleton.joint(file.skeleton.parent(j)).name,
                skeleton.joint(joint.parent).name);
    }
  }
  PLEAT_ASSERT_OK_AND_ASSIGN(const UserRig rig, ResolveRig(file, StillClip(figure)));
  // No leaf of the template moves anything, so no end is added.
  EXPECT_EQ(rig.skeleton.num_joints(), skeleton.num_joints());
  EXPECT_EQ(rig.weights->num_vertices(), figure.topology.num_vertices());
}

TEST(RigGlb, AnotherMeshIsRefused) {
  const SkinnedFigure figure = SmallFigure();
  PLEAT_ASSERT_OK_AND_ASSIGN(RigFile file, DecodeRigGlb(PackFigureGltf(MakeFigureGltf(figure))));
  file.positions.row(1) *= 1.3;
  EXPECT_THAT(ResolveRig(file, StillClip(figure)),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("nearest vertex")));
}

TEST(RigGlb, SaysWhatIsWrong) {
  const SkinnedFigure figure = SmallFigure();
  const auto expect_fault = [&](const std::function<void(json&)>& edit, const char* word) {
    const absl::StatusOr<RigFile> file = DecodeRigGlb(Edited(figure, edit));
    EXPECT_FALSE(file.ok()) << word;
    EXPECT_THAT(std::string(file.status().message()), HasSubstr(word));
  };
  expect_fault([](json& r) { r.erase("skins"); }, "no skin");
  expect_fault([](json& r) { r["skins"][0]["joints"] = {1}; }, "2 to 256");
  expect_fault([](json& r) { r["skins"][0]["joints"][0] = 999; }, "not a node");
  expect_fault([](json& r) { r["skins"][0]["joints"][0] = 1; }, "twice");
  expect_fault([](json& r) { r["nodes"][0]["children"] = {0}; }, "ancestor");
  expect_fault([](json& r) { r["nodes"][0]["children"] = {77}; }, "out of range");
  expect_fault([](json& r) { r["nodes"][1]["rotation"] = {0, 0, 0, 0}; }, "rotation");
  expect_fault([](json& r) { r["accessors"][0]["count"] = 1000000; }, "beyond");
  expect_fault([](json& r) { r["accessors"][1]["count"] = 3; }, "length");
  expect_fault([](json& r) { r["bufferViews"][0]["byteOffset"] = 1 << 30; }, "beyond");
  expect_fault([](json& r) { r["bufferViews"][0]["byteStride"] = 1 << 20; }, "beyond");
  expect_fault([](json& r) { r["buffers"] = {{{"uri", "/etc/passwd"}}}; }, "own binary");
  expect_fault([](json& r) { r["accessors"][0]["sparse"] = json::object(); }, "sparse");
  expect_fault([](json& r) { r["accessors"][2]["type"] = "VEC3"; }, "VEC4");
  expect_fault([](json& r) { r["meshes"][0]["primitives"][0]["attributes"].erase("JOINTS_0"); },
               "JOINTS_0");
  expect_fault([](json& r) { r["nodes"].back().erase("skin"); }, "no mesh");
  EXPECT_THAT(DecodeRigGlb(PackFigureGltf(MakeFigureGltf(figure)), {.max_vertices = 10}),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("10")));
}

TEST(RigGlb, DamagedBytesNeverCrash) {
  const std::string bytes =
      PackFigureGltf(MakeFigureGltf(MakeSkinnedFigure({.num_rings = 1, .num_sides = 1})));
  ForEachTruncation(bytes, [](const std::string& cut) { EXPECT_FALSE(DecodeRigGlb(cut).ok()); });
  std::string head = bytes;  // every byte of the header and the beginning of the JSON
  for (size_t i = 0; i < std::min<size_t>(bytes.size(), 2500); ++i) {
    for (const int value : {0, 255, int{'9'}, int{'-'}}) {
      head[i] = static_cast<char>(value);
      (void)DecodeRigGlb(head).ok();
    }
    head[i] = bytes[i];
  }
}

}  // namespace
}  // namespace pleat
