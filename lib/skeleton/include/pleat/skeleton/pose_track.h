// Poses over time, valid by construction.
#pragma once

#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "pleat/math/clip_starts.h"
#include "pleat/skeleton/pose.h"

namespace pleat {

// A track that was created has at least one pose, the same number of joints in all of them, finite
// root positions, unit rotations, a positive frame rate and clip starts inside its frames. Nobody
// downstream checks this again. A clip is a run of consecutive frames of one recording. History and
// dynamics never reach across the boundary of a clip.
class PoseTrack {
 public:
  // A track in the making. Anything may be set; Create checks all of it.
  struct Parts {
    double fps = 30;
    std::vector<Pose> poses{};        // T
    std::vector<int> clip_starts{0};  // the first frame of every clip, ascending from 0
  };

  // Makes a track without frames, for a place where the track is not there yet. Code that needs
  // frames asks num_frames().
  PoseTrack() : parts_{.clip_starts = {}} {}

  // kInvalidArgument names the first frame and joint that are wrong, or the entry of the clip
  // starts.
  static absl::StatusOr<PoseTrack> Create(Parts parts);
  // Does the same for code that made the parts itself and knows that they are valid (asserted).
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

  // The parts of the track, from which another one can be made.
  const Parts& parts() const { return parts_; }
  Parts Take() && { return std::exchange(parts_, Parts{.clip_starts = {}}); }

  // Returns the poses of `frame_indices`, in that order, as one clip. The indices must be in range,
  // and the list must not be empty (asserted).
  PoseTrack Subset(const std::vector<int>& frame_indices) const;

 private:
  explicit PoseTrack(Parts parts) : parts_(std::move(parts)) {}
  Parts parts_;
};

// OK when every pose has `num_joints` rotations. kInvalidArgument names both counts.
absl::Status CheckJointCount(const PoseTrack& track, int num_joints);

}  // namespace pleat
