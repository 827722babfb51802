#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "client/run_pleat.h"
#include "pleat/base/file.h"
#include "pleat/formats/bvh.h"
#include "pleat/formats/joint_map_file.h"
#include "pleat/skeleton/human_template.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(MotionMapVerbTest, TheMapOfAClipIsWritten) {
  const TemporaryFolder folder;
  ASSERT_THAT(WriteBvh(folder.File("a.bvh"), ClipFromPoses(HumanTemplate(), PoseTrack())), IsOk());
  const Outcome outcome =
      RunPleat({"motion", "map", folder.File("a.bvh"), "-o", folder.File("m.json"), "--json"});
  ASSERT_EQ(outcome.code, ExitCode::kOk) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json["schema"], "pleat.joint_map_written/1");
  EXPECT_EQ(json["num_mapped"], 18);
  PLEAT_ASSERT_OK_AND_ASSIGN(const JointMap map, ReadJointMap(folder.File("m.json")));
  EXPECT_EQ(map.joints[kLeftHand].from, "leftHand");
  EXPECT_EQ(map.joints[kLeftToes].alignment, BoneAlignment::kSole);
  // It is not replaced without --force.
  EXPECT_EQ(RunPleat({"motion", "map", folder.File("a.bvh"), "-o", folder.File("m.json")}).code,
            ExitCode::kUsage);
}

TEST(MotionMapVerbTest, WhatIsNoBodyIsRefused) {
  const TemporaryFolder folder;
  ASSERT_THAT(WriteFile(folder.File("a.bvh"),
                        "HIERARCHY\nROOT A { OFFSET 0 0 0 CHANNELS 0 End Site { OFFSET 0 1 0 } }\n"
                        "MOTION\nFrames: 1\nFrame Time: .1\n0\n"),
              IsOk());
  const Outcome outcome =
      RunPleat({"motion", "map", folder.File("a.bvh"), "-o", folder.File("m.json")});
  EXPECT_EQ(outcome.code, ExitCode::kBadInput);
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("pleat motion map: "), HasSubstr("a.bvh")));
}

}  // namespace
}  // namespace pleat
