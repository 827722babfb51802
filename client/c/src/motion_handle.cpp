#include <memory>
#include <vector>

#include "error_report.h"
#include "model_handle.h"
#include "pleat/base/status.h"
#include "pleat/skeleton/recent_motion.h"
#include "pose_argument.h"

struct pleat_motion {
  explicit pleat_motion(const pleat::CharacterModel& character)
      : num_joints(character.skeleton().num_joints()),
        recent(num_joints, 1 / character.frame_rate().fps(), character.options().history),
        pose(pleat::Pose::Rest(character.skeleton())),
        rotations(static_cast<size_t>(character.options().history)),
        shown(rotations.size()) {
    for (std::vector<double>& values : rotations) values.resize(4 * pose.rotations.size());
    history.reserve(rotations.size());
  }

  int num_joints;
  pleat::RecentMotion recent;
  pleat::Pose pose;  // the one that is being pushed
  std::vector<const pleat::Pose*> history;
  // What pleat_motion_poses() shows: of each pose 4 J numbers, and a struct that refers to them.
  std::vector<std::vector<double>> rotations;
  std::vector<pleat_pose> shown;
};

using pleat::Guarded;
using pleat::IsNull;

extern "C" {

pleat_code pleat_motion_create(const pleat_model* model, pleat_motion** motion,
                               pleat_error* error) {
  return Guarded(error, [&]() -> absl::Status {
    if (motion == nullptr) return IsNull("motion");
    *motion = nullptr;
    if (model == nullptr) return IsNull("model");
    *motion = new pleat_motion(*model->character);
    return absl::OkStatus();
  });
}

void pleat_motion_destroy(pleat_motion* motion) { delete motion; }

pleat_code pleat_motion_push(pleat_motion* motion, double seconds, const pleat_pose* pose,
                             pleat_error* error) {
  return Guarded(error, [&]() -> absl::Status {
    if (motion == nullptr) return IsNull("motion");
    if (pose == nullptr) return IsNull("pose");
    PLEAT_RETURN_IF_ERROR(pleat::TakePose(*pose, motion->num_joints, &motion->pose));
    PLEAT_RETURN_IF_ERROR(pleat::CheckPose(motion->pose));
    return motion->recent.Add(seconds, motion->pose);
  });
}

void pleat_motion_restart(pleat_motion* motion) {
  if (motion != nullptr) motion->recent.Restart();
}

pleat_code pleat_motion_poses(pleat_motion* motion, const pleat_pose** poses, size_t* num_poses,
                              pleat_error* error) {
  return Guarded(error, [&]() -> absl::Status {
    if (motion == nullptr) return IsNull("motion");
    if (poses == nullptr) return IsNull("poses");
    if (num_poses == nullptr) return IsNull("num_poses");
    if (motion->recent.empty()) {
      return absl::FailedPreconditionError("the motion has no pose yet: push one first");
    }
    motion->recent.History(&motion->history);
    for (size_t h = 0; h < motion->history.size(); ++h) {
      pleat::ShowPose(*motion->history[h], motion->rotations[h].data(), &motion->shown[h]);
    }
    *poses = motion->shown.data();
    *num_poses = motion->history.size();
    return absl::OkStatus();
  });
}

}  // extern "C"
