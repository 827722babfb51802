#include "cli/show/info_json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace pleat {
namespace {

using nlohmann::ordered_json;

TEST(InfoJsonTest, SequencesSayWhatTheyHold) {
  SequenceInfo info;
  info.id = "5e9";
  info.name = "dance";
  info.num_frames = 175;
  info.num_vertices = 10002;
  info.num_faces = 20000;
  info.frame_rate = {30000, 1001};
  info.size_bytes = 21'000'000'000;
  const ordered_json json = SequenceJson(info);
  EXPECT_EQ(json["id"], "5e9");
  EXPECT_EQ(json["name"], "dance");
  EXPECT_EQ(json["num_frames"], 175);
  EXPECT_EQ(json["num_vertices"], 10002);
  EXPECT_EQ(json["num_faces"], 20000);
  EXPECT_DOUBLE_EQ(json["fps"].get<double>(), 30000 / 1001.);
  EXPECT_EQ(json["size_bytes"].get<uint64_t>(), 21'000'000'000u);
  EXPECT_FALSE(json.contains("created"));
  info.life.created = absl::FromUnixMillis(1'796'072'709'123);
  EXPECT_EQ(SequenceJson(info)["created"], "2026-11-30T21:05:09.123Z");
}

TEST(InfoJsonTest, JobsSayTheirKindStateAndOptions) {
  JobInfo job;
  job.id = "1b";
  job.state = JobState::kRunning;
  job.sequence_ids = {"a", "b"};
  job.options = TrainOptions();
  job.name = "dance";
  job.stage = "fit";
  job.fraction = .25;
  job.warnings = {"open mesh"};
  const ordered_json json = JobJson(job);
  EXPECT_EQ(json["state"], "running");
  EXPECT_EQ(json["kind"], "training");
  EXPECT_EQ(json["sequence_ids"], (ordered_json{"a", "b"}));
  EXPECT_EQ(json["stage"], "fit");
  EXPECT_EQ(json["fraction"], .25);
  EXPECT_EQ(json["warnings"], ordered_json{"open mesh"});
  EXPECT_TRUE(json["options"].contains("seed"));
  job.options = CompressOptions{.max_error_mm = 2};
  EXPECT_EQ(JobJson(job)["kind"], "compression");
  EXPECT_EQ(JobJson(job)["options"]["max_error_mm"], 2);
}

// A reader asks `contains`: what is not known is not there, rather than null or zero.
TEST(InfoJsonTest, WhatAJobDoesNotKnowIsAbsent) {
  JobInfo job;
  for (const char* member : {"objective", "eta_seconds", "error", "result_id", "rig_id", "created",
                             "started", "ended"}) {
    EXPECT_FALSE(JobJson(job).contains(member)) << member;
  }
  job.objective = -3.5;
  job.eta_seconds = 12;
  job.error = absl::FailedPreconditionError("no human-like rig");
  job.result_id = "m1";
  job.rig_id = "r1";
  job.created = absl::FromUnixMillis(1'796'072'709'123);
  job.started = *job.created + absl::Seconds(1);
  job.ended = *job.created + absl::Seconds(2);
  const ordered_json json = JobJson(job);
  EXPECT_EQ(json["objective"], -3.5);
  EXPECT_EQ(json["eta_seconds"], 12);
  EXPECT_EQ(json["error"]["code"], "FAILED_PRECONDITION");
  EXPECT_EQ(json["error"]["message"], "no human-like rig");
  EXPECT_EQ(json["result_id"], "m1");
  EXPECT_EQ(json["rig_id"], "r1");
  EXPECT_EQ(json["created"], "2026-11-30T21:05:09.123Z");
  EXPECT_EQ(json["started"], "2026-11-30T21:05:10.123Z");
  EXPECT_EQ(json["ended"], "2026-11-30T21:05:11.123Z");
}

TEST(InfoJsonTest, ModelsListTheirJointsInOrderWithParents) {
  ModelInfo info;
  info.id = "m";
  info.skeleton = Skeleton::Create({{"hips", -1, {0, 1, 0}}, {"head", 0, {0, 1.7, .25}}}).value();
  info.record.learner = "gp";
  info.record.num_frames = 90;
  info.num_components = 12;
  const ordered_json json = ModelJson(info);
  EXPECT_EQ(json["learner"], "gp");
  EXPECT_EQ(json["num_training_frames"], 90);
  EXPECT_EQ(json["num_components"], 12);
  ASSERT_EQ(json["joints"].size(), 2u);
  EXPECT_EQ(json["joints"][0]["parent"], -1);
  EXPECT_EQ(json["joints"][1]["name"], "head");
  EXPECT_EQ(json["joints"][1]["position_m"], (ordered_json{0., 1.7, .25}));
}

TEST(InfoJsonTest, CompressedSequencesThatWereUploadedHaveNoReport) {
  CompressedSequenceInfo info;
  info.id = "c";
  info.num_frames = 10;
  info.num_vertices = 100;
  EXPECT_FALSE(CompressedSequenceJson(info).contains("report"));
  CompressionRecord record;
  record.sequence_id = "s";
  record.summary.num_bytes = 1234;
  record.encode_seconds = 1;
  record.decode_seconds = .5;
  info.record = record;
  const ordered_json json = CompressedSequenceJson(info);
  EXPECT_EQ(json["sequence_id"], "s");
  EXPECT_TRUE(json["options"].contains("max_error_mm"));
  EXPECT_EQ(json["report"]["bytes"], 1234);
}

}  // namespace
}  // namespace pleat
