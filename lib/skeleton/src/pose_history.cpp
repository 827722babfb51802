#include "pleat/skeleton/pose_history.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace pleat {
namespace {

Pose Interpolate(const Pose& a, const Pose& b, double fraction) {
  Pose pose;
  InterpolatePoses(a, b, fraction, &pose);
  return pose;
}

}  // namespace

Pose SamplePose(const PoseTrack& track, int clip_begin, int clip_end, double position) {
  assert(clip_begin < clip_end);
  if (clip_end - clip_begin == 1) return track.pose(clip_begin);
  const double clamped = std::clamp<double>(position, clip_begin - 1, clip_end - 1);
  // Both frames are in the clip. The fraction is negative before it, and 1 at the last frame.
  const int before = std::clamp(static_cast<int>(std::floor(clamped)), clip_begin, clip_end - 2);
  return Interpolate(track.pose(before), track.pose(before + 1), clamped - before);
}

FilledTrack FillGaps(const PoseTrack& track, const std::vector<int>& frame_numbers,
                     int max_missing) {
  assert(static_cast<int>(frame_numbers.size()) == track.num_frames());
  std::vector<int> rows;
  PoseTrack::Parts filled{.fps = track.fps(), .clip_starts = {}};
  const auto num_filled = [&filled] { return static_cast<int>(filled.poses.size()); };
  for (int i = 0; i < track.num_frames(); ++i) {
    const int step = i == 0 ? 0 : frame_numbers[i] - frame_numbers[i - 1];
    if (step > 1 && step <= max_missing + 1) {
      for (int k = 1; k < step; ++k) {
        filled.poses.push_back(
            Interpolate(track.pose(i - 1), track.pose(i), static_cast<double>(k) / step));
      }
    } else if (track.StartsClip(i)) {
      filled.clip_starts.push_back(num_filled());
    }
    rows.push_back(num_filled());
    filled.poses.push_back(track.pose(i));
  }
  return {PoseTrack::FromValid(std::move(filled)), std::move(rows)};
}

PoseHistory::PoseHistory(const PoseTrack& track, double interval_fps, int depth)
    : track_(track), frames_per_interval_(track.fps() / interval_fps), sampled_(depth) {
  assert(depth >= 1 && interval_fps > 0);
}

void PoseHistory::At(int t, std::vector<const Pose*>* poses) {
  const ClipRange clip = track_.ClipOf(t);
  poses->resize(sampled_.size());
  (*poses)[0] = &track_.pose(t);
  for (size_t h = 1; h < sampled_.size(); ++h) {
    const double position = t - static_cast<double>(h) * frames_per_interval_;
    const double nearest = std::round(position);
    if (std::abs(position - nearest) < 1e-6 && nearest >= clip.begin) {
      (*poses)[h] = &track_.pose(static_cast<int>(nearest));  // the very pose, without rounding
    } else {
      sampled_[h] = SamplePose(track_, clip.begin, clip.end, position);
      (*poses)[h] = &sampled_[h];
    }
  }
}

}  // namespace pleat
