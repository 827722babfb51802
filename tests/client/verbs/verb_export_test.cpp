#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "client/tube_files.h"
#include "pleat/formats/motion_reader.h"
#include "pleat/formats/sequence_reader.h"

namespace pleat {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class ExportVerbTest : public testing::Test {
 protected:
  Outcome Export(const std::string& output, std::vector<std::string> flags = {}) const {
    flags.insert(flags.begin(), {"export", files_.model_path(), "-o", files_.File(output)});
    return RunPleat(flags);
  }

  const TubeFiles files_;
};

TEST_F(ExportVerbTest, AGlbHasSkinAndMotion) {
  const Outcome outcome = Export("a.glb", {"--motion", files_.motion_path(), "--json"});
  ASSERT_EQ(outcome.code, ExitCode::kOk) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json["schema"], "pleat.export/1");
  EXPECT_EQ(json["num_frames"], TubeFiles::kNumMotionFrames);
  EXPECT_EQ(json["num_vertices"], TubeFiles::kNumVertices);
  EXPECT_EQ(json["influences"]["max_mm"], 0);
  EXPECT_FALSE(json.contains("target_errors"));
  PLEAT_ASSERT_OK_AND_ASSIGN(const Motion motion,
                             ReadMotion(files_.File("a.glb"), files_.model().skeleton()));
  EXPECT_EQ(motion.track.num_frames(), TubeFiles::kNumMotionFrames);
}

// An engine that knows skins and morph targets shows what `pleat pose` writes.
TEST_F(ExportVerbTest, MorphTargetsShowTheFramesOfPose) {
  const Outcome outcome = Export("a.glb", {"--motion", files_.motion_path(), "--targets", "6"});
  ASSERT_EQ(outcome.code, ExitCode::kOk) << outcome.err;
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("targets  rms mm  max mm"), HasSubstr("morph targets")));
  ASSERT_EQ(RunPleat({"pose", files_.model_path(), "--motion", files_.motion_path(), "-o",
                      files_.File("p.pseq")})
                .code,
            ExitCode::kOk);
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence shown, ReadSequence(files_.File("a.glb")));
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence posed, ReadSequence(files_.File("p.pseq")));
  ASSERT_EQ(shown.num_vertices(), posed.num_vertices());
  ASSERT_EQ(shown.num_frames(), posed.num_frames());
  for (int t = 0; t < posed.num_frames(); ++t) {
    EXPECT_LT((shown.frame(t) - posed.frame(t)).colwise().norm().maxCoeff(), 5e-6f) << t;
  }
}

TEST_F(ExportVerbTest, BvhAndUsdaAreWrittenByTheirEndings) {
  ASSERT_EQ(Export("a.bvh", {"--motion", files_.motion_path()}).code, ExitCode::kOk);
  PLEAT_ASSERT_OK_AND_ASSIGN(const Motion motion,
                             ReadMotion(files_.File("a.bvh"), files_.model().skeleton()));
  EXPECT_EQ(motion.track.num_frames(), TubeFiles::kNumMotionFrames);
  ASSERT_EQ(Export("a.usda", {"--motion", files_.motion_path(), "--points"}).code, ExitCode::kOk);
  EXPECT_THAT(*ReadFile(files_.File("a.usda")), HasSubstr("full_mesh"));
  ASSERT_EQ(Export("rest.glb").code, ExitCode::kOk);
}

// What was written for other programs drives `pleat pose` like the motion itself.
TEST_F(ExportVerbTest, WrittenMotionsDriveTheCharacter) {
  ASSERT_EQ(Export("a.bvh", {"--motion", files_.motion_path()}).code, ExitCode::kOk);
  ASSERT_EQ(Export("a.glb", {"--motion", files_.motion_path()}).code, ExitCode::kOk);
  const auto pose = [&](const std::string& motion, const std::string& output) {
    return RunPleat({"pose", files_.model_path(), "--motion", motion, "-o", files_.File(output)});
  };
  ASSERT_EQ(pose(files_.motion_path(), "json.pseq").code, ExitCode::kOk);
  PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence wanted, ReadSequence(files_.File("json.pseq")));
  for (const std::string name : {"bvh", "glb"}) {
    ASSERT_EQ(pose(files_.File("a." + name), name + ".pseq").code, ExitCode::kOk);
    PLEAT_ASSERT_OK_AND_ASSIGN(const MeshSequence posed, ReadSequence(files_.File(name + ".pseq")));
    for (int t = 0; t < wanted.num_frames(); ++t) {
      EXPECT_LT((posed.frame(t) - wanted.frame(t)).colwise().norm().maxCoeff(), 1e-5f) << name;
    }
  }
}

TEST_F(ExportVerbTest, FewerInfluencesSayWhatTheyCost) {
  const Outcome outcome = Export("a.glb", {"--motion", files_.motion_path(), "--influences", "1"});
  ASSERT_EQ(outcome.code, ExitCode::kOk) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("1 bones per vertex: "));
  EXPECT_EQ(Export("all.glb", {"--influences", "all"}).code, ExitCode::kOk);
  EXPECT_EQ(Export("b.glb", {"--influences", "9"}).code, ExitCode::kUsage);
}

TEST_F(ExportVerbTest, WhatDoesNotFitTogetherIsAUsageError) {
  const std::string motion = files_.motion_path();
  for (const auto& [output, flags] : std::vector<std::pair<std::string, std::vector<std::string>>>{
           {"a.fbx", {}},
           {"a.bvh", {"--motion", motion, "--targets", "3"}},
           {"a.glb", {"--targets", "3"}},
           {"a.glb", {"--motion", motion, "--points"}},
           {"a.glb", {"--motion", motion, "--targets", "3", "--max-error-mm", "1"}}}) {
    EXPECT_EQ(Export(output, flags).code, ExitCode::kUsage) << output;
  }
}

TEST_F(ExportVerbTest, StretchedBonesAreRefused) {
  ASSERT_EQ(RunPleat({"motion", files_.model_path(), files_.motion_path(), "-o",
                      files_.File("long.json"), "--bone-scale", "head=1.5"})
                .code,
            ExitCode::kOk);
  const Outcome outcome = Export("a.glb", {"--motion", files_.File("long.json")});
  EXPECT_EQ(outcome.code, ExitCode::kBadInput);
  EXPECT_THAT(outcome.err, HasSubstr("bone_scales"));
}

}  // namespace
}  // namespace pleat
