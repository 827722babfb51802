#include "pleat/formats/rig_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "pleat/base/file.h"
#include "support/hostile_bytes.h"
#include "support/skinned_figure.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

SkinnedFigure SmallFigure() { return MakeSkinnedFigure({.num_rings = 2, .num_sides = 3}); }

UserRig RigOf(const SkinnedFigure& figure) {
  return {figure.rig.skeleton, figure.rig.weights, 0, {1, 4, 17}};
}

MeshSequence StillClip(const SkinnedFigure& figure) {
  return *MeshSequence::Create(figure.topology, {figure.rig.rest_positions.cast<float>()},
                               {.name = "figure"});
}

TEST(RigFile, RoundTripIsExact) {
  const SkinnedFigure figure = SmallFigure();
  const UserRig rig = RigOf(figure);
  const std::string text = EncodeRig(rig);
  PLEAT_ASSERT_OK_AND_ASSIGN(const RigFile file, DecodeRigJson(text));
  PLEAT_ASSERT_OK_AND_ASSIGN(const UserRig back, ResolveRig(file, StillClip(figure)));
  EXPECT_EQ(back, rig);
  EXPECT_EQ(EncodeRig(back), text);
  // Shortest decimals: 10,000 vertices stay far below what a request may hold.
  EXPECT_LT(text.size(), 3000u + 70u * figure.topology.num_vertices());
  UserRig skeleton_only = rig;
  skeleton_only.weights.reset();
  PLEAT_ASSERT_OK_AND_ASSIGN(const RigFile bare, DecodeRigJson(EncodeRig(skeleton_only)));
  EXPECT_EQ(*ResolveRig(bare, StillClip(figure)), skeleton_only);
}

TEST(RigFile, LocksJointsByFlagAndByName) {
  const SkinnedFigure figure = SmallFigure();
  json root = json::parse(EncodeRig(RigOf(figure)));
  PLEAT_ASSERT_OK_AND_ASSIGN(RigFile file, DecodeRigJson(root.dump()));
  EXPECT_EQ(file.locked_joints, (std::vector<int>{1, 4, 17}));
  EXPECT_THAT(LockJoints({"head", "hips", "head"}, &file), IsOk());
  EXPECT_EQ(file.locked_joints, (std::vector<int>{0, 1, 3, 4, 17}));
  EXPECT_THAT(LockJoints({"tail"}, &file),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("'tail'")));
  root["locked"] = true;
  PLEAT_ASSERT_OK_AND_ASSIGN(const RigFile all, DecodeRigJson(root.dump()));
  EXPECT_EQ(ResolveRig(all, StillClip(figure))->locked_joints.size(), 18u);
}

// Weights of bones that are not as EncodeRig writes them: unsorted, doubled, of any sum.
TEST(RigFile, NormalizesWeightsOfBones) {
  const SkinnedFigure figure = SmallFigure();
  json root = json::parse(EncodeRig(RigOf(figure)));
  root["weights"]["vertices"][0] = {2, 1, 3, 2, 2, 1, 4, 4, 5, .5, 6, .25};
  PLEAT_ASSERT_OK_AND_ASSIGN(const RigFile file, DecodeRigJson(root.dump()));
  PLEAT_ASSERT_OK_AND_ASSIGN(const UserRig rig, ResolveRig(file, StillClip(figure)));
  ASSERT_TRUE(rig.weights.has_value());
  const VertexInfluences& vertex = rig.weights->vertex(0);
  EXPECT_EQ(vertex.bones, (std::array<uint16_t, 4>{4, 2, 3, 5}));
  EXPECT_FLOAT_EQ(vertex.weights[0], 4 / 8.5f);
  EXPECT_FLOAT_EQ(vertex.weights[3], .5f / 8.5f);
  root["weights"]["vertices"][0] = {0, 1};
  EXPECT_THAT(ResolveRig(*DecodeRigJson(root.dump()), StillClip(figure)),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("vertex 0")));
}

constexpr char kSmall[] = R"({"schema": "pleat.rig_file/1", "joints": [
    {"name": "root", "position_m": [0, 0, 0]},
    {"name": "tip", "parent": "root", "position_m": [0, 1, 0]},
    {"name": "side", "parent": 0, "position_m": [1, 1, 0]}],
    "weights": {"vertices": [[0, 1], [1, 0.5, 2, 0.5]]}, "locked": true, "rest_frame": 2})";

TEST(RigFile, ReadsParentsByNameAndIndex) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const RigFile file, DecodeRigJson(kSmall));
  EXPECT_EQ(file.skeleton.parent(1), 0);
  EXPECT_EQ(file.skeleton.parent(2), 0);
  EXPECT_EQ(file.rest_frame, 2);
  EXPECT_TRUE(file.is_locked);
  EXPECT_FALSE(file.influences_are_of_bones);
  ASSERT_EQ(file.influences.size(), 2u);
  EXPECT_EQ(file.influences[1][1].joint, 2);
}

TEST(RigFile, SaysWhatIsWrong) {
  const auto expect_fault = [](const std::function<void(json&)>& spoil, const char* word) {
    json root = json::parse(kSmall);
    spoil(root);
    EXPECT_THAT(DecodeRigJson(root.dump()),
                HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr(word)))
        << root.dump();
  };
  EXPECT_THAT(DecodeRigJson("{"), HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("JSON")));
  expect_fault([](json& r) { r = 3; }, "object");
  expect_fault([](json& r) { r["schema"] = "x"; }, "schema");
  expect_fault(
      [](json& r) {
        r["joints"].erase(2);
        r["joints"].erase(1);
      },
      "2 to 256");
  expect_fault([](json& r) { r["joints"][1].erase("name"); }, "joint 1 has no name");
  expect_fault([](json& r) { r["joints"][1]["parent"] = "tail"; }, "'tail'");
  expect_fault([](json& r) { r["joints"][1]["parent"] = 1; }, "'parent'");
  expect_fault([](json& r) { r["joints"][1]["parent"] = nullptr; }, "rig");
  expect_fault([](json& r) { r["joints"][1]["name"] = "root"; }, "rig");
  expect_fault([](json& r) { r["joints"][2]["position_m"] = {1, 2}; }, "position_m");
  expect_fault([](json& r) { r["joints"][2]["position_m"][0] = "x"; }, "finite");
  expect_fault([](json& r) { r["weights"]["of"] = "cows"; }, "weights.of");
  expect_fault([](json& r) { r["weights"]["vertices"] = json::array(); }, "every vertex");
  expect_fault([](json& r) { r["weights"]["vertices"][1] = {1}; }, "vertex 1");
  expect_fault([](json& r) { r["weights"]["vertices"][1] = {7, 1}; }, "vertex 1");
  expect_fault([](json& r) { r["weights"]["vertices"][1] = {1, -1}; }, "vertex 1");
  expect_fault([](json& r) { r["rest_frame"] = -1; }, "rest_frame");
  expect_fault([](json& r) { r["locked"] = 1; }, "locked");
  expect_fault([](json& r) { r["joints"][2]["locked"] = "yes"; }, "joint 2");
  EXPECT_THAT(DecodeRigJson(std::string(1'000'000, '[')),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("nested")));
  EXPECT_THAT(DecodeRigJson(kSmall, {.max_document_bytes = 10}),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("limit")));
  EXPECT_THAT(DecodeRigJson(kSmall, {.max_vertices = 1}),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("limit")));
}

TEST(RigFile, DamagedTextNeverCrashes) {
  ForEachTruncation(kSmall,
                    [](const std::string& text) { EXPECT_FALSE(DecodeRigJson(text).ok()); });
  ForEachCorruption(kSmall, [](const std::string& text) { (void)DecodeRigJson(text).ok(); });
}

TEST(RigFile, ResolvesForTheClip) {
  const SkinnedFigure figure = SmallFigure();
  const UserRig rig = RigOf(figure);
  PLEAT_ASSERT_OK_AND_ASSIGN(RigFile file, DecodeRigJson(EncodeRig(rig)));
  PLEAT_ASSERT_OK_AND_ASSIGN(const UserRig resolved, ResolveRig(file, StillClip(figure)));
  EXPECT_EQ(resolved.skeleton.num_joints(), rig.skeleton.num_joints());
  EXPECT_TRUE(resolved.weights->ToDense().isApprox(rig.weights->ToDense(), 1e-5));

  RigFile other = file;
  other.rest_frame = 1;
  EXPECT_THAT(ResolveRig(other, StillClip(figure)),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("rest_frame 1")));
  other = file;
  other.influences.pop_back();
  EXPECT_THAT(ResolveRig(other, StillClip(figure)),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("vertices")));
  other = file;
  other.skeleton = file.skeleton.WithRestPositions(100 * file.skeleton.RestPositions());
  EXPECT_THAT(ResolveRig(other, StillClip(figure)),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("unit")));
}

// --- GLB ---

// A binary glTF of a figure: the skin's joints in reverse order, an armature node that scales from
// centimeters, weights of joints (that of a bone belongs to the joint it turns about).
std::string MakeGlb(const SkinnedFigure& figure, const std::function<void(json&)>& edit = {}) {
  const Skeleton& skeleton = figure.rig.skeleton;
  const int num_joints = skeleton.num_joints();
  const int num_vertices = figure.topology.num_vertices();
  std::string binary;
  json root;
  const auto add = [&](const auto& values, int component, const char* type, int count) {
    json view = {{"buffer", 0},
                 {"byteOffset", binary.size()},
                 {"byteLength", values.size() * sizeof(values[0])}};
    root["bufferViews"].push_back(view);
    root["accessors"].push_back({{"bufferView", root["bufferViews"].size() - 1},
                                 {"componentType", component},
                                 {"type", type},
                                 {"count", count}});
    binary.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(values[0]));
    binary.resize((binary.size() + 3) / 4 * 4);
  };
  std::vector<float> positions, weights, binds;
  std::vector<uint16_t> joints;
  for (int v = 0; v < num_vertices; ++v) {
    for (int k = 0; k < 3; ++k) {
      positions.push_back(static_cast<float>(100 * figure.rig.rest_positions(k, v)));
    }
    const VertexInfluences& influences = figure.rig.weights.vertex(v);
    for (int k = 0; k < 4; ++k) {
      const int parent = influences.weights[k] > 0 ? skeleton.parent(influences.bones[k]) : 0;
      joints.push_back(static_cast<uint16_t>(num_joints - 1 - parent));
      weights.push_back(influences.weights[k]);
    }
  }
  root["scene"] = 0;
  root["nodes"] = {{{"name", "armature"}, {"scale", {.01, .01, .01}}, {"children", {1}}}};
  for (int j = 0; j < num_joints; ++j) {
    const Eigen::Vector3d parent = skeleton.parent(j) < 0
                                       ? Eigen::Vector3d(0, 0, 0)
                                       : skeleton.rest_position(skeleton.parent(j));
    const Eigen::Vector3d offset = 100 * (skeleton.rest_position(j) - parent);
    json node = {{"name", skeleton.joint(j).name},
                 {"translation", {offset.x(), offset.y(), offset.z()}}};
    for (const int child : skeleton.children(j)) node["children"].push_back(child + 1);
    root["nodes"].push_back(node);
  }
  root["nodes"].push_back({{"name", "body"}, {"mesh", 0}, {"skin", 0}});
  for (int j = num_joints - 1; j >= 0; --j) {
    root["skins"][0]["joints"].push_back(j + 1);
    for (int k = 0; k < 16; ++k) {
      binds.push_back(k % 5 == 0 ? 1.f
                      : k >= 12  ? static_cast<float>(-100 * skeleton.rest_position(j)[k - 12])
                                 : 0.f);
    }
  }
  add(positions, 5126, "VEC3", num_vertices);
  add(joints, 5123, "VEC4", num_vertices);
  add(weights, 5126, "VEC4", num_vertices);
  add(binds, 5126, "MAT4", num_joints);
  root["skins"][0]["inverseBindMatrices"] = 3;
  root["meshes"] = {
      {{"primitives", {{{"attributes", {{"POSITION", 0}, {"JOINTS_0", 1}, {"WEIGHTS_0", 2}}}}}}}};
  root["buffers"] = {{{"byteLength", binary.size()}}};
  root["asset"]["version"] = "2.0";
  if (edit) edit(root);
  std::string text = root.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const auto u32 = [](size_t value) {
    const auto narrow = static_cast<uint32_t>(value);
    return std::string(reinterpret_cast<const char*>(&narrow), 4);
  };
  return "glTF" + u32(2) + u32(28 + text.size() + binary.size()) + u32(text.size()) + "JSON" +
         text + u32(binary.size()) + std::string("BIN\0", 4) + binary;
}

TEST(RigGlb, GivesNamesHierarchyPlacesAndWeights) {
  const SkinnedFigure figure = SmallFigure();
  const Skeleton& skeleton = figure.rig.skeleton;
  PLEAT_ASSERT_OK_AND_ASSIGN(const RigFile file, DecodeRigGlb(MakeGlb(figure)));
  ASSERT_EQ(file.skeleton.num_joints(), skeleton.num_joints());
  for (const Joint& joint : skeleton.joints()) {
    const int j = file.skeleton.FindJoint(joint.name);
    ASSERT_GE(j, 0) << joint.name;
    EXPECT_LT((file.skeleton.rest_position(j) - joint.rest_position).norm(), 1e-5);
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
  PLEAT_ASSERT_OK_AND_ASSIGN(RigFile file, DecodeRigGlb(MakeGlb(figure)));
  file.positions.row(1).array() += .3;
  EXPECT_THAT(ResolveRig(file, StillClip(figure)),
              HasStatus(absl::StatusCode::kInvalidArgument, HasSubstr("nearest vertex")));
}

TEST(RigGlb, SaysWhatIsWrong) {
  const SkinnedFigure figure = SmallFigure();
  const auto expect_fault = [&](const std::function<void(json&)>& edit, const char* word) {
    const absl::StatusOr<RigFile> file = DecodeRigGlb(MakeGlb(figure, edit));
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
  expect_fault([](json& r) { r["buffers"][0]["uri"] = "/etc/passwd"; }, "own binary");
  expect_fault([](json& r) { r["accessors"][0]["sparse"] = json::object(); }, "sparse");
  expect_fault([](json& r) { r["accessors"][2]["type"] = "VEC3"; }, "VEC4");
  expect_fault([](json& r) { r["meshes"][0]["primitives"][0]["attributes"].erase("JOINTS_0"); },
               "JOINTS_0");
  expect_fault([](json& r) { r["nodes"].back().erase("skin"); }, "no mesh");
  EXPECT_THAT(DecodeRigGlb(MakeGlb(figure), {.max_vertices = 10}),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("10")));
}

TEST(RigGlb, DamagedBytesNeverCrash) {
  const std::string bytes = MakeGlb(MakeSkinnedFigure({.num_rings = 1, .num_sides = 1}));
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

TEST(RigFile, TheEndingChoosesTheFormat) {
  const TemporaryFolder folder;
  ASSERT_THAT(WriteFile(folder.File("a.json"), kSmall), IsOk());
  ASSERT_THAT(WriteFile(folder.File("a.GLB"), MakeGlb(SmallFigure())), IsOk());
  EXPECT_THAT(ReadRigFile(folder.File("a.json")), IsOk());
  EXPECT_THAT(ReadRigFile(folder.File("a.GLB")), IsOk());
  EXPECT_THAT(ReadRigFile(folder.File("b.json")),
              HasStatus(absl::StatusCode::kNotFound, ::testing::_));
}

}  // namespace
}  // namespace pleat
