#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"
#include "pleat/rigging/heat_weights.h"
#include "training_steps.h"

namespace pleat {

absl::StatusOr<RiggedFrames> TakeUserRig(const TrainingFrames& frames, const UserRig& rig,
                                         const TrainResources& resources,
                                         const Progress& progress) {
  if (rig.rest_frame < 0 || rig.rest_frame >= frames.num_rig_frames) {
    return absl::InvalidArgumentError(absl::StrCat("rig: rest_frame ", rig.rest_frame,
                                                   " is not one of the first clip's ",
                                                   frames.num_rig_frames, " frames"));
  }
  if (rig.weights && (rig.weights->num_vertices() != frames.sequence.num_vertices() ||
                      rig.weights->num_joints() != rig.skeleton.num_joints())) {
    return absl::InvalidArgumentError(absl::StrCat(
        "rig: weights of ", rig.weights->num_vertices(), " vertices and ",
        rig.weights->num_joints(), " joints; the clip has ", frames.sequence.num_vertices(),
        " vertices, the skeleton ", rig.skeleton.num_joints(), " joints"));
  }
  RiggedFrames rigged{.frames = frames,
                      .rig = {rig.skeleton, {}, frames.sequence.FrameAsDouble(rig.rest_frame)},
                      .rig_summary = {},
                      .locked_joints = rig.locked_joints};
  rigged.rig_summary.rest_frame = rig.rest_frame;
  if (rig.weights) {
    rigged.rig.weights = *rig.weights;
  } else {
    HeatWeightsOptions heat;
    heat.num_threads = resources.num_threads;
    PLEAT_ASSIGN_OR_RETURN(
        rigged.rig.weights,
        ComputeHeatWeights(frames.sequence.topology(), rigged.rig.rest_positions, rig.skeleton,
                           heat, &rigged.rig_summary.heat, progress));
  }
  return rigged;
}

}  // namespace pleat
