// One value of every kind of stored record, with every field set. tests/golden/records holds their
// bytes as Pleat 0.1.0 wrote them, so the values here must never change.
#pragma once

#include <limits>
#include <string>

#include "absl/strings/str_cat.h"
#include "pleat/character/train_options.h"
#include "pleat/service/character_service.h"

namespace pleat {

inline SequenceInfo SampleSequence() {
  return {.id = std::string(64, 'a'),
          .name = "Gr\xc3\xbc\xc3\x9f\xff",  // its last byte is not UTF-8 and becomes U+FFFD
          .num_frames = 175,
          .num_vertices = 9971,
          .num_faces = 19938,
          .frame_rate = {30000, 1001},
          .size_bytes = uint64_t{1} << 33};
}

inline TrainOptions SampleTrainOptions() {
  return ParseTrainOptions(absl::StrCat("learner=gp\n"
                                        "fit=walk\n"
                                        "refine=none\n"
                                        "deformation=full\n"
                                        "detail_axes=world\n"
                                        "detail_coordinates=differential\n"
                                        "rotations=quaternion\n"
                                        "history=3\n"
                                        "history_form=poses\n"
                                        "resolution_percent=5.1\n"
                                        "upsampling=rbf\n"
                                        "rest_frame=17\n"
                                        "yaw_degrees=90.5\n"
                                        "bend_stiffness=0.1\n"
                                        "smoothness=0.3\n"
                                        "latent_dimensions=7\n"
                                        "iterations=321\n"
                                        "dynamics_weight=0.3333333333333333\n"
                                        "detail_energy=0.5\n"
                                        "max_components=11\n"
                                        "seed=",
                                        std::numeric_limits<uint64_t>::max(), "\n"))
      .value();
}

inline JobInfo SampleTrainingJob() {
  JobInfo job;
  job.id = "job-1";
  job.state = JobState::kFailed;
  job.sequence_ids = {std::string(64, 'a'), std::string(64, 'b')};
  job.options = SampleTrainOptions();
  job.name = "walk";
  job.rig_id = std::string(64, 'c');
  job.stage = "learn";
  job.fraction = .25;
  job.objective = -3.5;
  job.eta_seconds = 12.5;
  job.warnings = {"first", "second"};
  job.error = absl::FailedPreconditionError("no rig fits");
  job.result_id = std::string(64, 'd');
  return job;
}

inline CompressOptions SampleCompressOptions() {
  return {.goal = CompressionGoal::kKg, .kg_percent = .05, .keep_face_order = false};
}

inline JobInfo SampleCompressionJob() {
  JobInfo job;
  job.id = "job-2";
  job.state = JobState::kSucceeded;
  job.sequence_ids = {std::string(64, 'a')};
  job.options = SampleCompressOptions();
  job.name = "walk";
  job.fraction = 1;
  job.result_id = std::string(64, 'd');
  return job;
}

inline ModelInfo SampleModel() {
  ModelInfo model{
      .id = std::string(64, 'e'),
      .name = "walk",
      .skeleton = Skeleton::Create({{"hips", -1, {0, 1, 0}}, {"chest", 0, {0, 1.4, .01}}}).value(),
      .frame_rate = {25, 1},
      .num_vertices = 9971,
      .num_faces = 19938,
      .num_control_vertices = 499,
      .num_components = 64,
      .size_bytes = 123456,
      .memory_bytes = 7654321,
      .options = SampleTrainOptions(),
      .record = {}};
  model.record.learner = "gp";
  model.record.num_frames = 175;
  model.record.rest_frame = 17;
  model.record.yaw_degrees = 90.5;
  model.record.rig_residual = .01;
  model.record.diagonal_m = 2.1;
  model.record.fit.mean_percent = .5;
  model.record.fit.rms_percent = 1.25;
  model.record.fit.p95_percent = 2.5;
  model.record.fit.max_percent = 4.75;
  model.record.fit.mean_mm = 9.5;
  model.record.fit.motion_mean_percent = .125;
  model.record.reconstruction.mean_mm = .5;
  model.record.warnings = {"careful"};
  model.record.worst_frames = {{1, 7, 2.5}, {0, 3, 2}};
  model.record.joint_fit_percent = {0, .5};
  model.record.pose_jitter_degrees = .25;
  model.record.unsmoothed_jitter_degrees = .375;
  model.record.unsmoothed_rms_percent = .625;
  model.record.validation = {9, {{"gp", .25}, {"sgplvm", .5}}};
  return model;
}

inline CompressedSequenceInfo SampleCompressedSequence() {
  CompressedSequenceInfo info{.id = std::string(64, 'd'),
                              .name = "walk",
                              .num_frames = 175,
                              .num_vertices = 9971,
                              .num_faces = 19938,
                              .frame_rate = {25, 1},
                              .size_bytes = 54321,
                              .record = CompressionRecord{}};
  info.record->sequence_id = std::string(64, 'a');
  info.record->options = SampleCompressOptions();
  info.record->summary.num_bytes = 54321;
  info.record->summary.num_topology_bytes = 4321;
  info.record->summary.bpvf = 1.5;
  info.record->summary.bpvf_without_topology = 1.25;
  info.record->summary.kg_percent = .049;
  info.record->summary.max_error_mm = 3.25;
  info.record->encode_seconds = 7;
  info.record->decode_seconds = .75;
  return info;
}

}  // namespace pleat
