#include "pleat/formats/joint_map_file.h"

#include <nlohmann/json.hpp>

#include "pleat/base/file.h"
#include "support/hostile_bytes.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;

JointMap SmallMap() {
  JointMap map;
  map.up = ClipUp::kZ;
  map.scale = .01;
  map.joints = {{"hips", "Hips", "Hips", BoneAlignment::kRotation},
                {"head", "", ""},
                {"leftFoot", "LeftAnkle", "LeftKnee", BoneAlignment::kDirection},
                {"leftToes", "LeftToe", "LeftAnkle", BoneAlignment::kSole}};
  map.left_out = {"Tail"};
  return map;
}

TEST(JointMapFileTest, AMapComesBack) {
  const TemporaryFolder folder;
  ASSERT_THAT(WriteJointMap(folder.File("m.json"), SmallMap()), IsOk());
  PLEAT_ASSERT_OK_AND_ASSIGN(const JointMap map, ReadJointMap(folder.File("m.json")));
  EXPECT_EQ(EncodeJointMap(map), EncodeJointMap(SmallMap()));
  EXPECT_EQ(map.up, ClipUp::kZ);
  EXPECT_EQ(map.scale, .01);
  EXPECT_EQ(map.joints[1].from, "");
  EXPECT_EQ(map.joints[3].alignment, BoneAlignment::kSole);
  EXPECT_THAT(map.left_out, ElementsAre("Tail"));
}

TEST(JointMapFileTest, WhatPeopleLeaveOutHasDefaults) {
  PLEAT_ASSERT_OK_AND_ASSIGN(
      const JointMap map,
      DecodeJointMap(
          R"({"schema": "pleat.joint_map/1", "joints": [{"joint": "a", "from": "b"}]})"));
  EXPECT_EQ(map.up, ClipUp::kAuto);
  EXPECT_FALSE(map.scale.has_value());
  EXPECT_EQ(map.joints[0].turns_with, "");
  EXPECT_EQ(map.joints[0].alignment, BoneAlignment::kDirection);
}

TEST(JointMapFileTest, MistakesAreNamed) {
  const json valid = json::parse(EncodeJointMap(SmallMap()));
  const auto expect = [&](auto damage, const char* reason) {
    json map = valid;
    damage(map);
    EXPECT_THAT(DecodeJointMap(map.dump()), HasStatus(kInvalid, HasSubstr(reason)));
  };
  expect([](json& m) { m["schema"] = "pleat.joint_map/9"; }, "'schema' must be");
  expect([](json& m) { m.erase("joints"); }, "'joints' must be a list");
  expect([](json& m) { m["joints"][1] = 7; }, "joints[1] must be an object");
  expect([](json& m) { m["joints"][1].erase("joint"); }, "joints[1] needs 'joint'");
  expect([](json& m) { m["joints"][1]["joint"] = "hips"; }, "'hips' is driven twice");
  expect([](json& m) { m["joints"][2]["from"] = 5; }, "('leftFoot'): 'from' must be a text");
  expect([](json& m) { m["joints"][2]["from"] = ""; }, "'turns_with' and no 'from'");
  expect([](json& m) { m["joints"][2]["align"] = "up\n"; }, "'up\\x0a'; choose one of direction");
  expect([](json& m) { m["up"] = "x"; }, "choose one of auto, y, z");
  expect([](json& m) { m["scale"] = 0; }, "'scale' must be a number");
  expect([](json& m) { m["scale"] = "1"; }, "'scale' must be a number");
  EXPECT_THAT(DecodeJointMap(""), HasStatus(kInvalid, HasSubstr("not JSON")));
  EXPECT_THAT(DecodeJointMap("[]"), HasStatus(kInvalid, HasSubstr("JSON object")));
  EXPECT_THAT(DecodeJointMap(std::string(100'000, '[')),
              HasStatus(kInvalid, HasSubstr("too deep")));
}

TEST(JointMapFileTest, LimitsAreKept) {
  EXPECT_THAT(DecodeJointMap(std::string((4 << 20) + 1, ' ')),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("the limit is")));
  json map = {{"schema", "pleat.joint_map/1"}, {"joints", json::array()}};
  for (int i = 0; i < 4097; ++i) map["joints"].push_back({{"joint", std::to_string(i)}});
  EXPECT_THAT(DecodeJointMap(map.dump()),
              HasStatus(absl::StatusCode::kResourceExhausted, HasSubstr("4097 joints")));
}

TEST(JointMapFileTest, DamagedMapsAreRefusedOrRead) {
  const std::string text = EncodeJointMap(SmallMap());
  ForEachTruncation(text, [](const std::string& damaged) { (void)DecodeJointMap(damaged); });
  ForEachCorruption(text, [](const std::string& damaged) { (void)DecodeJointMap(damaged); });
}

}  // namespace
}  // namespace pleat
