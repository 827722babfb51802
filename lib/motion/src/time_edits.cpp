#include "time_edits.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "blending.h"
#include "pleat/base/status.h"
#include "pleat/motion/apply_edits.h"
#include "pleat/skeleton/pose_history.h"

namespace pleat {
namespace {

absl::Status CheckFrames(double num_frames) {
  if (num_frames <= kMaxEditedFrames) return absl::OkStatus();
  return absl::ResourceExhaustedError(
      absl::StrCat("the edit makes ", num_frames, " frames; the limit is ", kMaxEditedFrames));
}

absl::Status CheckOneClip(const PoseTrack& track) {
  if (track.clip_starts().size() == 1) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat("the motion has ", track.clip_starts().size(),
                                                 " clips, and this edit takes one"));
}

Pose Between(const Pose& a, const Pose& b, double fraction) {
  Pose pose;
  InterpolatePoses(a, b, fraction, &pose);
  return pose;
}

// The slopes of the cubic through the keys: harmonic means of those of the pieces, so that the
// curve never turns back.
std::vector<double> MonotoneSlopes(const std::vector<double>& x, const std::vector<double>& y) {
  std::vector<double> pieces, slopes;
  for (size_t i = 0; i + 1 < x.size(); ++i) {
    pieces.push_back((y[i + 1] - y[i]) / (x[i + 1] - x[i]));
  }
  slopes.push_back(pieces.front());
  for (size_t i = 1; i < pieces.size(); ++i) {
    const double before = x[i] - x[i - 1], after = x[i + 1] - x[i];
    const double a = (2 * after + before) / pieces[i - 1], b = (after + 2 * before) / pieces[i];
    slopes.push_back(3 * (before + after) / (a + b));
  }
  slopes.push_back(pieces.back());
  return slopes;
}

double Cubic(double u, double length, double y0, double y1, double m0, double m1) {
  const double v = u * u * (3 - 2 * u);
  return (1 - v) * y0 + v * y1 + length * (u * (1 - u) * (1 - u) * m0 - u * u * (1 - u) * m1);
}

absl::Status CheckKeys(const PoseTrack& track, const std::vector<double>& from,
                       const std::vector<double>& to) {
  if (from.size() != to.size() || from.size() < 2) {
    return absl::InvalidArgumentError("time_warp needs two keys or more, each with two times");
  }
  for (size_t i = 1; i < from.size(); ++i) {
    if (from[i] > from[i - 1] && to[i] > to[i - 1]) continue;
    return absl::InvalidArgumentError(
        absl::StrCat("the times of time_warp must ascend: key ", i, " does not"));
  }
  const double seconds = (track.num_frames() - 1) / track.fps();
  if (from.back() <= seconds + 1e-6) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat("time_warp takes what is at ", from.back(),
                                                 " s; the motion ends at ", seconds, " s"));
}

}  // namespace

absl::StatusOr<PoseTrack> ScaleTime(const PoseTrack& track, double factor) {
  PLEAT_RETURN_IF_ERROR(CheckFrames(track.num_frames() * factor));
  PoseTrack::Parts scaled{.fps = track.fps(), .clip_starts = {}};
  for (const int begin : track.clip_starts()) {
    const int end = track.ClipOf(begin).end;
    scaled.clip_starts.push_back(static_cast<int>(scaled.poses.size()));
    const long last = std::lround((end - begin - 1) * factor);
    for (long t = 0; t <= last; ++t) {
      const double position = std::min<double>(begin + static_cast<double>(t) / factor, end - 1);
      scaled.poses.push_back(SamplePose(track, begin, end, position));
    }
  }
  return PoseTrack::Create(std::move(scaled));
}

absl::StatusOr<PoseTrack> ResampleTime(const PoseTrack& track, double fps) {
  PLEAT_ASSIGN_OR_RETURN(PoseTrack scaled, ScaleTime(track, fps / track.fps()));
  PoseTrack::Parts parts = std::move(scaled).Take();
  parts.fps = fps;
  return PoseTrack::Create(std::move(parts));
}

absl::StatusOr<PoseTrack> WarpTime(const PoseTrack& track, const std::vector<double>& from,
                                   const std::vector<double>& to) {
  PLEAT_RETURN_IF_ERROR(CheckOneClip(track));
  PLEAT_RETURN_IF_ERROR(CheckKeys(track, from, to));
  const double last = std::floor((to.back() - to.front()) * track.fps() + 1e-6);
  PLEAT_RETURN_IF_ERROR(CheckFrames(last + 1));
  const std::vector<double> slopes = MonotoneSlopes(to, from);
  PoseTrack::Parts warped{.fps = track.fps()};
  size_t key = 0;
  for (int t = 0; t <= last; ++t) {
    const double seconds = to.front() + t / track.fps();
    while (key + 2 < to.size() && seconds > to[key + 1]) ++key;
    const double length = to[key + 1] - to[key];
    const double source = Cubic((seconds - to[key]) / length, length, from[key], from[key + 1],
                                slopes[key], slopes[key + 1]);
    const double position = std::clamp(source * track.fps(), 0., track.num_frames() - 1.);
    warped.poses.push_back(SamplePose(track, 0, track.num_frames(), position));
  }
  return PoseTrack::Create(std::move(warped));
}

absl::StatusOr<PoseTrack> TrimTime(const PoseTrack& track, double from_seconds, double to_seconds) {
  PLEAT_RETURN_IF_ERROR(CheckOneClip(track));
  const auto first = static_cast<int64_t>(std::ceil(from_seconds * track.fps() - 1e-6));
  const auto last = std::min<int64_t>(track.num_frames() - 1,
                                      std::llround(std::floor(to_seconds * track.fps() + 1e-6)));
  if (first > last) {
    return absl::InvalidArgumentError(absl::StrCat("no frame is between ", from_seconds, " s and ",
                                                   to_seconds, " s: the motion ends at ",
                                                   (track.num_frames() - 1) / track.fps(), " s"));
  }
  PoseTrack::Parts kept{.fps = track.fps()};
  kept.poses.assign(track.poses().begin() + first, track.poses().begin() + last + 1);
  return PoseTrack::Create(std::move(kept));
}

absl::StatusOr<PoseTrack> LoopTrack(const PoseTrack& track, double blend_seconds, int count,
                                    const BodyAxes& axes) {
  PLEAT_RETURN_IF_ERROR(CheckOneClip(track));
  const int last = track.num_frames() - 1;
  if (last < 1) return absl::InvalidArgumentError("a motion of one frame is no loop");
  PLEAT_RETURN_IF_ERROR(CheckFrames(static_cast<double>(last) * count + 1));
  const int blend = std::clamp(static_cast<int>(std::lround(blend_seconds * track.fps())), 1, last);
  const GroundMove start = GroundOf(track.pose(0), axes), end = GroundOf(track.pose(last), axes);
  const GroundMove round = end * start.Inverse();
  std::vector<Pose> closed = track.poses();
  for (int t = last - blend + 1; t <= last; ++t) {
    const double fraction = SmoothStep(static_cast<double>(t - last + blend) / blend);
    // What the first pose is where frame t stands on the ground, so that only the body is drawn to
    // it and the way stays.
    Pose first = track.pose(0);
    (GroundOf(track.pose(t), axes) * start.Inverse()).Apply(&first);
    closed[static_cast<size_t>(t)] = Between(track.pose(t), first, fraction);
  }
  PoseTrack::Parts looped{.fps = track.fps()};
  GroundMove move;
  for (int c = 0; c < count; ++c) {
    for (int t = 0; t < (c + 1 < count ? last : last + 1); ++t) {
      looped.poses.push_back(closed[static_cast<size_t>(t)]);
      if (c > 0) move.Apply(&looped.poses.back());
    }
    move = move * round;
  }
  return PoseTrack::Create(std::move(looped));
}

absl::StatusOr<PoseTrack> BlendTracks(const PoseTrack& track, const PoseTrack& other,
                                      const std::vector<int>& joints, double weight,
                                      const BodyAxes& axes) {
  PLEAT_RETURN_IF_ERROR(CheckOneClip(track));
  PLEAT_RETURN_IF_ERROR(CheckOneClip(other));
  const GroundMove move = GroundOf(track.pose(0), axes) * GroundOf(other.pose(0), axes).Inverse();
  const double step = track.num_frames() < 2
                          ? 0
                          : static_cast<double>(other.num_frames() - 1) / (track.num_frames() - 1);
  PoseTrack::Parts blended = track.parts();
  for (int t = 0; t < track.num_frames(); ++t) {
    const double position = std::min<double>(t * step, other.num_frames() - 1);
    Pose towards = SamplePose(other, 0, other.num_frames(), position);
    move.Apply(&towards);
    Pose& pose = blended.poses[static_cast<size_t>(t)];
    const Pose mixed = Between(pose, towards, weight);
    for (const int j : joints) {
      pose.rotations[static_cast<size_t>(j)] = mixed.rotations[static_cast<size_t>(j)];
      if (j == 0) pose.root_position = mixed.root_position;
    }
  }
  return PoseTrack::Create(std::move(blended));
}

absl::StatusOr<PoseTrack> ConcatenateTracks(const PoseTrack& track, const PoseTrack& other,
                                            double blend_seconds, const BodyAxes& axes) {
  PLEAT_RETURN_IF_ERROR(CheckOneClip(track));
  PLEAT_RETURN_IF_ERROR(CheckOneClip(other));
  PLEAT_ASSIGN_OR_RETURN(PoseTrack next, ResampleTime(other, track.fps()));
  PLEAT_RETURN_IF_ERROR(CheckFrames(track.num_frames() + next.num_frames()));
  const int blend = std::min({static_cast<int>(std::lround(blend_seconds * track.fps())),
                              track.num_frames() - 1, next.num_frames() - 1});
  const int meet = track.num_frames() - 1 - blend;  // the frame at which `next` begins
  const GroundMove move = GroundOf(track.pose(meet), axes) * GroundOf(next.pose(0), axes).Inverse();
  PoseTrack::Parts joined{.fps = track.fps()};
  joined.poses.assign(track.poses().begin(), track.poses().begin() + meet);
  for (int t = 0; t < next.num_frames(); ++t) {
    Pose pose = next.pose(t);
    move.Apply(&pose);
    if (t <= blend) {
      const double fraction = blend == 0 ? 1 : SmoothStep(static_cast<double>(t) / blend);
      pose = Between(track.pose(meet + t), pose, fraction);
    }
    joined.poses.push_back(std::move(pose));
  }
  return PoseTrack::Create(std::move(joined));
}

}  // namespace pleat
