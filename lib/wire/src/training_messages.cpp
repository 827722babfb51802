#include "pleat/wire/training_messages.h"

#include <string>

#include "pleat/base/status.h"
#include "pleat/base/utf8.h"
#include "pleat/wire/skeleton_messages.h"

namespace pleat {

v1::TrainOptions ToProto(const TrainOptions& options) {
  v1::TrainOptions message;
  message.set_learner(options.learner);
  message.set_fit(options.fit);
  message.set_detail_axes(options.detail_axes);
  message.set_deformation(options.deformation);
  message.set_detail_coordinates(options.detail_coordinates);
  message.set_rotations(options.rotations);
  message.set_history(options.history);
  message.set_resolution_percent(options.resolution_percent);
  message.set_rest_frame(options.rest_frame);
  message.set_yaw_degrees(options.yaw_degrees);
  message.set_latent_dimensions(options.latent_dimensions);
  message.set_iterations(options.iterations);
  message.set_dynamics_weight(options.dynamics_weight);
  message.set_detail_energy(options.detail_energy);
  message.set_max_components(options.max_components);
  message.set_seed(options.seed);
  message.set_history_form(options.history_form);
  message.set_upsampling(options.upsampling);
  message.set_bend_stiffness(options.bend_stiffness);
  message.set_refine(options.refine);
  message.set_smoothness(options.smoothness);
  return message;
}

absl::StatusOr<TrainOptions> FromProto(const v1::TrainOptions& message) {
  TrainOptions options;
  if (message.has_learner()) options.learner = message.learner();
  if (message.has_fit()) options.fit = message.fit();
  if (message.has_detail_axes()) options.detail_axes = message.detail_axes();
  if (message.has_deformation()) options.deformation = message.deformation();
  if (message.has_detail_coordinates()) options.detail_coordinates = message.detail_coordinates();
  if (message.has_rotations()) options.rotations = message.rotations();
  if (message.has_history()) options.history = message.history();
  if (message.has_resolution_percent()) options.resolution_percent = message.resolution_percent();
  if (message.has_rest_frame()) options.rest_frame = message.rest_frame();
  if (message.has_yaw_degrees()) options.yaw_degrees = message.yaw_degrees();
  if (message.has_latent_dimensions()) options.latent_dimensions = message.latent_dimensions();
  if (message.has_iterations()) options.iterations = message.iterations();
  if (message.has_dynamics_weight()) options.dynamics_weight = message.dynamics_weight();
  if (message.has_detail_energy()) options.detail_energy = message.detail_energy();
  if (message.has_max_components()) options.max_components = message.max_components();
  if (message.has_seed()) options.seed = message.seed();
  if (message.has_history_form()) options.history_form = message.history_form();
  if (message.has_upsampling()) options.upsampling = message.upsampling();
  if (message.has_bend_stiffness()) options.bend_stiffness = message.bend_stiffness();
  if (message.has_refine()) options.refine = message.refine();
  if (message.has_smoothness()) options.smoothness = message.smoothness();
  PLEAT_RETURN_IF_ERROR(ValidateTrainOptions(options));
  return options;
}

v1::TrainingRecord ToProto(const TrainingRecord& record) {
  v1::TrainingRecord message;
  message.set_learner(record.learner);
  message.set_num_frames(record.num_frames);
  message.set_rest_frame(record.rest_frame);
  message.set_yaw_degrees(record.yaw_degrees);
  message.set_rig_residual(record.rig_residual);
  message.set_diagonal_m(record.diagonal_m);
  *message.mutable_fit() = ToProto(record.fit);
  *message.mutable_reconstruction() = ToProto(record.reconstruction);
  for (const std::string& warning : record.warnings) message.add_warnings(ToValidUtf8(warning));
  for (const FrameError& error : record.worst_frames) {
    v1::FrameError* out = message.add_worst_frames();
    out->set_clip(error.clip);
    out->set_frame(error.frame);
    out->set_mean_percent(error.mean_percent);
  }
  message.mutable_joint_fit_percent()->Assign(record.joint_fit_percent.begin(),
                                              record.joint_fit_percent.end());
  message.set_pose_jitter_degrees(record.pose_jitter_degrees);
  message.set_unsmoothed_jitter_degrees(record.unsmoothed_jitter_degrees);
  message.set_unsmoothed_rms_percent(record.unsmoothed_rms_percent);
  message.set_num_held_out_frames(record.validation.num_held_out_frames);
  for (const auto& [learner, percent] : record.validation.mean_percent) {
    (*message.mutable_validation_mean_percent())[learner] = percent;
  }
  return message;
}

TrainingRecord FromProto(const v1::TrainingRecord& message) {
  TrainingRecord record;
  record.learner = message.learner();
  record.num_frames = message.num_frames();
  record.rest_frame = message.rest_frame();
  record.yaw_degrees = message.yaw_degrees();
  record.rig_residual = message.rig_residual();
  record.diagonal_m = message.diagonal_m();
  record.fit = FromProto(message.fit());
  record.reconstruction = FromProto(message.reconstruction());
  record.warnings.assign(message.warnings().begin(), message.warnings().end());
  for (const v1::FrameError& error : message.worst_frames()) {
    record.worst_frames.push_back({error.clip(), error.frame(), error.mean_percent()});
  }
  record.joint_fit_percent.assign(message.joint_fit_percent().begin(),
                                  message.joint_fit_percent().end());
  record.pose_jitter_degrees = message.pose_jitter_degrees();
  record.unsmoothed_jitter_degrees = message.unsmoothed_jitter_degrees();
  record.unsmoothed_rms_percent = message.unsmoothed_rms_percent();
  record.validation.num_held_out_frames = message.num_held_out_frames();
  record.validation.mean_percent.insert(message.validation_mean_percent().begin(),
                                        message.validation_mean_percent().end());
  return record;
}

}  // namespace pleat
