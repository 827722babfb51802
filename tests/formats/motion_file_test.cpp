#include "pleat/formats/motion_file.h"

#include <nlohmann/json.hpp>

#include "absl/strings/str_cat.h"
#include "pleat/base/file.h"
#include "pleat/math/rotations.h"
#include "pleat/skeleton/human_template.h"
#include "support/hostile_bytes.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

json Valid() {
  return json::parse(R"({"schema": "pleat.motion/1", "fps": 25, "joints": ["head", "hips"],
    "frames": [{"root_translation": [0, 1, 2], "rotations": [[1, 0, 0, 0], [0, 2, 0, 0]]},
               {"root_translation": [0, 1, 3], "rotations": [[0.6, 0, 0.8, 0], [1, 0, 0, 0]]}]})");
}

absl::StatusOr<Motion> Decode(const json& motion, const MeshLimits& limits = {}) {
  return DecodeMotion(motion.dump(), HumanTemplate(), limits);
}

TEST(MotionFileTest, JointsAreMatchedByNameInAnyOrder) {
  PLEAT_ASSERT_OK_AND_ASSIGN(const Motion motion, Decode(Valid()));
  EXPECT_EQ(motion.track.fps(), 25);
  ASSERT_EQ(motion.track.num_frames(), 2);
  const Pose& first = motion.track.pose(0);
  EXPECT_EQ(first.root_position, Eigen::Vector3d(0, 1, 2));
  ASSERT_EQ(first.rotations.size(), 18u);
  EXPECT_EQ(first.rotations[kHips].x(), 1);  // [0, 2, 0, 0] normalized; w comes first
  EXPECT_EQ(first.rotations[kHips].w(), 0);
  EXPECT_EQ(motion.track.pose(1).rotations[kHead].y(), 0.8);
  EXPECT_EQ(first.rotations[kLeftFoot].w(), 1);
  EXPECT_TRUE(motion.bone_scales.empty());
  EXPECT_THAT(motion.warnings, ElementsAre(AllOf(HasSubstr("stay at rest"), HasSubstr("leftFoot")),
                                           HasSubstr("1 rotations were not of length 1")));
}

TEST(MotionFileTest, ColumnsAreTheSameMotion) {
  json columns = Valid();
  for (const json& frame : columns["frames"]) {
    columns["root_translation"].push_back(frame["root_translation"]);
    columns["rotations"].push_back(frame["rotations"]);
  }
  columns.erase("frames");
  PLEAT_ASSERT_OK_AND_ASSIGN(const Motion a, Decode(columns));
  PLEAT_ASSERT_OK_AND_ASSIGN(const Motion b, Decode(Valid()));
  EXPECT_EQ(EncodeMotion(HumanTemplate(), a.track), EncodeMotion(HumanTemplate(), b.track));
  columns["rotations"].erase(1);
  EXPECT_THAT(Decode(columns), HasStatus(kInvalid, HasSubstr("each of the 2 frames")));
}

TEST(MotionFileTest, WrittenMotionReadsBack) {
  PoseTrack::Parts parts{.fps = 29.97, .clip_starts = {0, 2}};
  for (int t = 0; t < 4; ++t) {
    Pose pose = Pose::Rest(HumanTemplate());
    pose.root_position = {0.1 * t, 1.0 / 3, 2};
    for (size_t j = 0; j < pose.rotations.size(); ++j) {
      pose.rotations[j] =
          QuaternionFromExponentialMap({0.1 * t, 0.2 * static_cast<double>(j), 0.3});
    }
    parts.poses.push_back(pose);
  }
  const PoseTrack track = PoseTrack::FromValid(std::move(parts));
  std::vector<double> scales(18, 1);
  scales[kLeftFoot] = 1.25;
  const TemporaryFolder folder;
  ASSERT_THAT(WriteMotion(folder.File("m.json"), HumanTemplate(), track, scales), IsOk());
  PLEAT_ASSERT_OK_AND_ASSIGN(const Motion read,
                             DecodeMotion(*ReadFile(folder.File("m.json")), HumanTemplate()));
  EXPECT_TRUE(read.warnings.empty());
  EXPECT_EQ(read.bone_scales, scales);
  EXPECT_EQ(read.track.fps(), 29.97);
  EXPECT_THAT(read.track.clip_starts(), ElementsAre(0, 2));
  for (int t = 0; t < 4; ++t) {
    EXPECT_EQ(read.track.pose(t).root_position, track.pose(t).root_position);
    for (int j = 0; j < 18; ++j) {
      EXPECT_TRUE(read.track.pose(t).rotations[j].isApprox(track.pose(t).rotations[j], 1e-14));
    }
  }
}

TEST(MotionFileTest, UnknownJointListsTheKnownOnes) {
  json motion = Valid();
  motion["joints"][0] = "Head";
  EXPECT_THAT(Decode(motion), HasStatus(kInvalid, AllOf(HasSubstr("no joint 'Head'"),
                                                        HasSubstr("hips, spine, chest, head"))));
  motion["joints"][0] = "hips";
  EXPECT_THAT(Decode(motion), HasStatus(kInvalid, HasSubstr("'hips' is listed twice")));
  motion = Valid();
  motion["bone_scales"]["tail"] = 2;
  EXPECT_THAT(Decode(motion), HasStatus(kInvalid, HasSubstr("no joint 'tail'")));
}

TEST(MotionFileTest, EachFaultIsNamed) {
  const struct {
    const char* pointer;
    json value;
    const char* message;
  } kCases[] = {
      {"/schema", "pleat.motion/2", "pleat.motion/1"},
      {"/fps", 0, "'fps'"},
      {"/fps", "30", "'fps'"},
      {"/fps", 1e6, "'fps'"},
      {"/joints", json::array(), "'joints'"},
      {"/joints/1", 7, "names only"},
      {"/frames", json::array(), "no frames"},
      {"/frames/1", 3, "frame 1 needs"},
      {"/frames/1/root_translation", {1, 2}, "frame 1, root_translation must be a list of 3"},
      {"/frames/1/root_translation/2", nullptr, "entry 2 is not a finite number"},
      {"/frames/1/rotations/0", {1, 0, 0}, "frame 1, rotation of 'head' must be a list of 4"},
      {"/frames/1/rotations/1", {0, 0, 0, 0}, "frame 1, rotation of 'hips' has length 0"},
      {"/frames/0/rotations", json::array({json::array({1, 0, 0, 0})}), "frame 0 has 1 rotations"},
      {"/bone_scales", {{"head", 0}}, "above 0"},
      {"/bone_scales", 3, "'bone_scales'"},
      {"/clip_starts", {1}, "'clip_starts'"},
      {"/clip_starts", {0, 2}, "'clip_starts'"},
      {"/clip_starts", 5, "'clip_starts'"},
  };
  for (const auto& [pointer, value, message] : kCases) {
    json motion = Valid();
    motion[json::json_pointer(pointer)] = value;
    EXPECT_THAT(Decode(motion), HasStatus(kInvalid, HasSubstr(message))) << pointer;
  }
  for (const char* field : {"schema", "fps", "joints", "frames"}) {
    json motion = Valid();
    motion.erase(field);
    EXPECT_THAT(Decode(motion), HasStatus(kInvalid, HasSubstr(field)));
  }
}

TEST(MotionFileTest, TextThatIsNotJsonSaysWhere) {
  EXPECT_THAT(DecodeMotion("", HumanTemplate()), HasStatus(kInvalid, HasSubstr("empty")));
  EXPECT_THAT(DecodeMotion("{\"fps\": NaN}", HumanTemplate()),
              HasStatus(kInvalid, AllOf(HasSubstr("not JSON"), HasSubstr("line 1, column 9"))));
  EXPECT_THAT(DecodeMotion("[1e999]", HumanTemplate()), HasStatus(kInvalid, testing::_));
  EXPECT_THAT(DecodeMotion("[]", HumanTemplate()), HasStatus(kInvalid, HasSubstr("JSON object")));
  EXPECT_THAT(DecodeMotion(std::string(100'000, '['), HumanTemplate()),
              HasStatus(kInvalid, HasSubstr("not JSON")));
}

TEST(MotionFileTest, LimitsAndUnknownFields) {
  EXPECT_THAT(Decode(Valid(), {.max_frames = 1}),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("2 frames")));
  EXPECT_THAT(Decode(Valid(), {.max_document_bytes = 50}),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("limit is 50")));
  json motion = Valid();
  motion["unit"] = "cm";
  PLEAT_ASSERT_OK_AND_ASSIGN(const Motion read, Decode(motion));
  EXPECT_THAT(read.warnings, testing::Contains(HasSubstr("\"unit\" is ignored")));
}

TEST(MotionFileTest, DamagedFilesFailCleanlyOrReadUnitRotations) {
  const std::string text = Valid().dump();
  const auto decode = [](const std::string& damaged) {
    const absl::StatusOr<Motion> motion = DecodeMotion(damaged, HumanTemplate());
    if (!motion.ok()) return;
    for (const Pose& pose : motion->track.poses()) {
      ASSERT_EQ(pose.rotations.size(), 18u);
      for (const Eigen::Quaterniond& q : pose.rotations) EXPECT_NEAR(q.norm(), 1, 1e-9);
    }
  };
  ForEachTruncation(text, [](const std::string& damaged) {
    EXPECT_FALSE(DecodeMotion(damaged, HumanTemplate()).ok());
  });
  ForEachCorruption(text, decode);
}

}  // namespace
}  // namespace pleat
