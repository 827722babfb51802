#include "pleat/skeleton/pose_history.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace pleat {
namespace {

// a at fraction 0, b at fraction 1; fractions outside [0, 1] extrapolate.
Pose Interpolate(const Pose& a, const Pose& b, double fraction) {
  Pose pose;
  pose.root_position = a.root_position + fraction * (b.root_position - a.root_position);
  pose.rotations.reserve(a.rotations.size());
  for (size_t j = 0; j < a.rotations.size(); ++j) {
    pose.rotations.push_back(a.rotations[j].slerp(fraction, b.rotations[j]).normalized());
  }
  return pose;
}

}  // namespace

Pose SamplePose(const PoseTrack& track, int clip_begin, int clip_end, double position) {
  assert(clip_begin < clip_end);
  if (clip_end - clip_begin == 1) return track.poses[clip_begin];
  const double clamped = std::clamp<double>(position, clip_begin - 1, clip_end - 1);
  const int before = std::clamp(static_cast<int>(std::floor(clamped)), clip_begin, clip_end - 2);
  return Interpolate(track.poses[before], track.poses[before + 1], clamped - before);
}

FilledTrack FillGaps(const PoseTrack& track, const std::vector<int>& frame_numbers,
                     int max_missing) {
  assert(static_cast<int>(frame_numbers.size()) == track.num_frames());
  FilledTrack filled;
  filled.track.fps = track.fps;
  filled.track.clip_starts.clear();
  for (int i = 0; i < track.num_frames(); ++i) {
    const int step = i == 0 ? 0 : frame_numbers[i] - frame_numbers[i - 1];
    if (step > 1 && step <= max_missing + 1) {
      for (int k = 1; k < step; ++k) {
        filled.track.poses.push_back(
            Interpolate(track.poses[i - 1], track.poses[i], static_cast<double>(k) / step));
      }
    } else if (std::binary_search(track.clip_starts.begin(), track.clip_starts.end(), i)) {
      filled.track.clip_starts.push_back(filled.track.num_frames());
    }
    filled.rows.push_back(filled.track.num_frames());
    filled.track.poses.push_back(track.poses[i]);
  }
  return filled;
}

PoseHistory::PoseHistory(const PoseTrack& track, double interval_fps, int depth)
    : track_(track), frames_per_interval_(track.fps / interval_fps), sampled_(depth) {
  assert(depth >= 1 && interval_fps > 0);
}

void PoseHistory::At(int t, std::vector<const Pose*>* poses) {
  const auto next_clip = std::upper_bound(track_.clip_starts.begin(), track_.clip_starts.end(), t);
  const int clip_end = next_clip == track_.clip_starts.end() ? track_.num_frames() : *next_clip;
  const int clip_begin = *(next_clip - 1);
  poses->resize(sampled_.size());
  (*poses)[0] = &track_.poses[t];
  for (size_t h = 1; h < sampled_.size(); ++h) {
    const double position = t - static_cast<double>(h) * frames_per_interval_;
    const double nearest = std::round(position);
    if (std::abs(position - nearest) < 1e-6 && nearest >= clip_begin) {
      (*poses)[h] = &track_.poses[static_cast<int>(nearest)];  // no rounding by interpolation
    } else {
      sampled_[h] = SamplePose(track_, clip_begin, clip_end, position);
      (*poses)[h] = &sampled_[h];
    }
  }
}

}  // namespace pleat
