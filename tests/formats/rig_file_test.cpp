#include "pleat/formats/rig_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "figure_glb.h"
#include "pleat/base/file.h"
#include "support/hostile_bytes.h"
#include "support/skinned_figure.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

UserRig RigOf(const SkinnedFigure& figure) {
  return {figure.rig.skeleton, figure.rig.weights, 0, {1, 4, 17}};
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
  EXPECT_EQ(vertex.bones, (std::array<uint16_t, kMaxInfluences>{4, 2, 3, 5, 6}));
  EXPECT_FLOAT_EQ(vertex.weights[0], 4 / 8.75f);
  EXPECT_FLOAT_EQ(vertex.weights[3], .5f / 8.75f);
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

TEST(RigFile, TheEndingChoosesTheFormat) {
  const TemporaryFolder folder;
  ASSERT_THAT(WriteFile(folder.File("a.json"), kSmall), IsOk());
  ASSERT_THAT(WriteFile(folder.File("a.GLB"), PackFigureGltf(MakeFigureGltf(SmallFigure()))),
              IsOk());
  EXPECT_THAT(ReadRigFile(folder.File("a.json")), IsOk());
  EXPECT_THAT(ReadRigFile(folder.File("a.GLB")), IsOk());
  EXPECT_THAT(ReadRigFile(folder.File("b.json")),
              HasStatus(absl::StatusCode::kNotFound, ::testing::_));
}

}  // namespace
}  // namespace pleat
