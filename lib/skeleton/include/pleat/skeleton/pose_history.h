// The predecessors of every pose of a track, at any frame rate.
#pragma once

#include <vector>

#include "pleat/skeleton/pose_track.h"

namespace pleat {

// Returns the pose at `position` of the clip [clip_begin, clip_end) of `track`. The position counts
// frames; between frames, rotations are interpolated by slerp and the root linearly. Before the
// clip its first motion continues backwards with constant velocity, but not farther than one frame.
// A clip of one frame stands still.
Pose SamplePose(const PoseTrack& track, int clip_begin, int clip_end, double position);

// Finds the history of every pose at the intervals that a model was trained with, so that
// velocities mean the same at any frame rate (docs/method/fit.md#history). History never crosses
// the boundary of a clip. Serves one thread: it owns the poses that it interpolates.
class PoseHistory {
 public:
  // `track` must outlive this object. interval_fps: the frame rate of the model, which the
  // intervals of the history follow. depth: the number of poses per row with the current one, at
  // least 1.
  PoseHistory(const PoseTrack& track, double interval_fps, int depth);

  // Sets poses[0] to the pose of frame t and poses[h] to the pose h intervals earlier. The pointers
  // are valid until the next call.
  void At(int t, std::vector<const Pose*>* poses);

 private:
  const PoseTrack& track_;
  double frames_per_interval_;
  std::vector<Pose> sampled_;  // depth: the poses that lie between frames
};

// A track whose short gaps are filled by interpolation, and where its own frames went.
struct FilledTrack {
  PoseTrack track;
  std::vector<int> rows;  // rows[i] is the frame of `track` that was frame i of the input
};

// Fills short gaps of `track`. frame_numbers: the place of every frame in its recording, ascending
// within a clip. Where at most `max_missing` numbers are missing between two frames, the poses
// between them are interpolated and no clip starts after them. Wider gaps remain clip starts.
FilledTrack FillGaps(const PoseTrack& track, const std::vector<int>& frame_numbers,
                     int max_missing);

}  // namespace pleat
