// The predecessors of every pose of a track, at any frame rate.
#pragma once

#include <vector>

#include "pleat/skeleton/pose_track.h"

namespace pleat {

// The pose at `position` (in frames, fractions interpolate: slerp, linear root) of the clip
// [clip_begin, clip_end) of `track`. Positions before the clip continue its first motion backwards
// (constant velocity), at most one frame far; a clip of one frame stands still.
Pose SamplePose(const PoseTrack& track, int clip_begin, int clip_end, double position);

// Finds each pose's history at the intervals that a model was trained with, so that velocity means
// the same at any frame rate (docs/method/fit.md#history). History never crosses a clip boundary.
class PoseHistory {
 public:
  // track must outlive this; interval_fps: frame rate of the history (the model's); depth >= 1:
  // poses per row, the current one included.
  PoseHistory(const PoseTrack& track, double interval_fps, int depth);

  // poses[0] = pose of frame t, poses[h] = the pose h intervals earlier. The pointers are valid
  // until the next call.
  void At(int t, std::vector<const Pose*>* poses);

 private:
  const PoseTrack& track_;
  double frames_per_interval_;
  std::vector<Pose> sampled_;  // depth
};

// A track whose short gaps are filled by interpolation, and where its own frames went.
struct FilledTrack {
  PoseTrack track;
  std::vector<int> rows;  // rows[i]: frame of `track` that is frame i of the input
};

// frame_numbers: one per frame of `track`, ascending within a clip: its place in the recording.
// Where at most `max_missing` numbers are missing between two frames, the poses between them are
// interpolated and no clip starts after them; wider gaps stay the clip starts they are.
FilledTrack FillGaps(const PoseTrack& track, const std::vector<int>& frame_numbers,
                     int max_missing);

}  // namespace pleat
