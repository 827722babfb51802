#include "pleat/skeleton/pose_track.h"

#include <cassert>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

absl::Status InFrame(size_t t, const absl::Status& status) {
  return absl::Status(status.code(),
                      absl::StrCat("frame ", t, ": ", absl::string_view(status.message())));
}

absl::Status Check(const PoseTrack::Parts& parts) {
  if (!(parts.fps > 0) || !std::isfinite(parts.fps)) {
    return absl::InvalidArgumentError(
        absl::StrCat("the pose track's fps is ", parts.fps, ", which is not a positive number"));
  }
  if (parts.poses.empty()) {
    return absl::InvalidArgumentError("the pose track is empty; give at least one pose");
  }
  const size_t num_joints = parts.poses[0].rotations.size();
  if (num_joints == 0) return absl::InvalidArgumentError("frame 0: the pose has no rotations");
  for (size_t t = 0; t < parts.poses.size(); ++t) {
    if (parts.poses[t].rotations.size() != num_joints) {
      return absl::InvalidArgumentError(
          absl::StrCat("frame ", t, ": the pose has ", parts.poses[t].rotations.size(),
                       " rotations, that of frame 0 has ", num_joints));
    }
    if (absl::Status status = CheckPose(parts.poses[t]); !status.ok()) return InFrame(t, status);
  }
  return CheckClipStarts(parts.clip_starts, static_cast<int64_t>(parts.poses.size()));
}

}  // namespace

absl::StatusOr<PoseTrack> PoseTrack::Create(Parts parts) {
  PLEAT_RETURN_IF_ERROR(Check(parts));
  return PoseTrack(std::move(parts));
}

PoseTrack PoseTrack::FromValid(Parts parts) {
  assert(Check(parts).ok());
  return PoseTrack(std::move(parts));
}

PoseTrack PoseTrack::Subset(const std::vector<int>& frame_indices) const {
  assert(!frame_indices.empty());
  Parts subset{.fps = parts_.fps};
  subset.poses.reserve(frame_indices.size());
  for (const int t : frame_indices) subset.poses.push_back(pose(t));
  return PoseTrack(std::move(subset));
}

absl::Status CheckJointCount(const PoseTrack& track, int num_joints) {
  // All poses of a track have the same number of joints, so the first one stands for all.
  if (track.num_frames() == 0) return absl::OkStatus();
  absl::Status status = CheckJointCount(track.pose(0), num_joints);
  return status.ok() ? status : InFrame(0, status);
}

}  // namespace pleat
