// Poses over time. Valid by construction.
#pragma once

#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "pleat/math/clip_starts.h"
#include "pleat/skeleton/pose.h"

namespace pleat {

// A track that was created has at least one pose, the same number of joints in all of them, finite
// root positions, unit rotations, a positive frame rate and clip starts inside its frames; nobody
// downstream checks again. A clip is a run of consecutive frames of one recording; history and
// dynamics never reach across a clip boundary.
class PoseTrack {
 public:
  // A track in the making: anything may be set, Create checks all of it.
  struct Parts {
    double fps = 30;
    std::vector<Pose> poses{};        // T
    std::vector<int> clip_starts{0};  // first frame of every clip, ascending, first is 0
  };

  // No frames: the place of a track that is not there yet. Whoever needs frames asks num_frames().
  PoseTrack() : parts_{.clip_starts = {}} {}

  // kInvalidArgument names the first faulty frame and joint, or the entry of the clip starts.
  static absl::StatusOr<PoseTrack> Create(Parts parts);
  // The same by code that made the parts itself and knows that they are valid (asserted).
  static PoseTrack FromValid(Parts parts);

  double fps() const { return parts_.fps; }
  int num_frames() const { return static_cast<int>(parts_.poses.size()); }
  int num_joints() const {
    return parts_.poses.empty() ? 0 : static_cast<int>(parts_.poses[0].rotations.size());
  }
  const std::vector<Pose>& poses() const { return parts_.poses; }
  const Pose& pose(int t) const { return parts_.poses[static_cast<size_t>(t)]; }
  const std::vector<int>& clip_starts() const { return parts_.clip_starts; }
  ClipRange ClipOf(int t) const { return ClipOfFrame(parts_.clip_starts, num_frames(), t); }
  bool StartsClip(int t) const { return ClipOf(t).begin == t; }

  // What the track is made of, to make another one.
  const Parts& parts() const { return parts_; }
  Parts Take() && { return std::exchange(parts_, Parts{.clip_starts = {}}); }

  // The poses of `frame_indices`, in that order, as one clip. Indices must be in range and the list
  // not empty.
  PoseTrack Subset(const std::vector<int>& frame_indices) const;

 private:
  explicit PoseTrack(Parts parts) : parts_(std::move(parts)) {}
  Parts parts_;
};

// OK when the poses have `num_joints` rotations each; kInvalidArgument names both counts.
absl::Status CheckJointCount(const PoseTrack& track, int num_joints);

}  // namespace pleat
