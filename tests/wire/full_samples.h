// Values of the service in which every member differs from its default.
#pragma once

#include "pleat/wire/service_messages.h"
#include "pleat/wire/skeleton_messages.h"
#include "pleat/wire/stream_messages.h"
#include "wire/message_samples.h"

namespace pleat {

inline ErrorSummary FullErrors() {
  ErrorSummary errors;
  errors.mean_percent = 1;
  errors.rms_percent = 2;
  errors.p95_percent = 3;
  errors.max_percent = 4;
  errors.mean_mm = 5;
  errors.motion_mean_percent = 6;
  return errors;
}

inline EntryLife FullLife() {
  return {.created = absl::FromUnixMillis(1'796'072'709'123),
          .expires = absl::FromUnixMillis(1'796'072'719'123),
          .pinned = true};
}

inline SequenceInfo FullSequence() { return {kId, "walk", 7, 8, 9, {30000, 1001}, 11, FullLife()}; }

inline CompressedSequenceInfo FullCompressedSequence() {
  const CompressOptions options{
      .goal = CompressionGoal::kKg, .kg_percent = 2.5, .keep_face_order = false};
  return {kId,       "walk",        7,  8,
          9,         {30000, 1001}, 11, CompressionRecord{kId, options, {1, 2, 3, 4, 5, 6}, 7, 8},
          FullLife()};
}

inline JobInfo FullJob(JobOptions options) {
  JobInfo job;
  job.id = "job-1";
  job.state = JobState::kFailed;
  job.sequence_ids = {kId, std::string(64, 'b')};
  job.options = std::move(options);
  job.name = "dancer";
  job.rig_id = std::string(64, 'c');
  job.stage = "learn";
  job.fraction = .25;
  job.objective = -3.5;
  job.eta_seconds = 12;
  job.warnings = {"one", "two"};
  job.error = absl::FailedPreconditionError("no rig fits");
  job.result_id = std::string(64, 'd');
  job.created = absl::FromUnixMillis(1'796'072'709'123);
  job.started = *job.created + absl::Seconds(1);
  job.ended = *job.created + absl::Seconds(2);
  job.result_ttl = absl::Seconds(90);
  return job;
}

inline ModelInfo FullModel() {
  ModelInfo model;
  model.id = kId;
  model.name = "dancer";
  model.skeleton =
      Skeleton::Create({{"hips", -1, {.1, 1, .2}}, {"chest", 0, {.3, 1.4, .01}}}).value();
  model.frame_rate = {30000, 1001};
  model.num_vertices = 5;
  model.num_faces = 6;
  model.num_control_vertices = 3;
  model.num_components = 4;
  model.life = FullLife();
  model.size_bytes = 7;
  model.memory_bytes = 8;
  model.options.seed = 9;
  TrainingRecord& record = model.record;
  record.learner = "gp";
  record.num_frames = 10;
  record.rest_frame = 11;
  record.yaw_degrees = 12;
  record.rig_residual = .01;
  record.diagonal_m = 2;
  record.fit = record.reconstruction = FullErrors();
  record.warnings = {"careful"};
  record.worst_frames = {{1, 7, 2.5}};
  record.joint_fit_percent = {0, .5};
  record.pose_jitter_degrees = .25;
  record.unsmoothed_jitter_degrees = .375;
  record.unsmoothed_rms_percent = .625;
  record.validation = {9, {{"gp", .25}}};
  return model;
}

inline StreamHeader FullHeader() {
  StreamHeader header;
  header.encoding = FrameEncoding::kDracoDelta;
  header.content = StreamContent::kControlMesh;
  header.num_vertices = 3;
  header.num_points = 4;
  header.num_triangles = 1;
  header.box = {{1, -2, .5f}, 2.5f, 14};
  header.topology = std::string("\0DRACO", 6);
  header.vertex_order = {2, 0, 1};
  header.control_vertices = {4, 7, 9};
  return header;
}

inline FrameParameters FullParameters() {
  Random random(3);
  FrameParameters parameters;
  parameters.pose = RandomPose(&random, 3);
  parameters.coefficients = Eigen::VectorXf::LinSpaced(4, .5f, 2);
  return parameters;
}

inline PoseTrack FullTrack() {
  Random random(4);
  PoseTrack::Parts parts{.fps = 25, .clip_starts = {0, 2}};
  for (int t = 0; t < 4; ++t) parts.poses.push_back(RandomPose(&random, 3));
  return PoseTrack::FromValid(std::move(parts));
}

}  // namespace pleat
