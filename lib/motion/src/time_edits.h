// Edits of when poses are shown, and of two motions together. All but ScaleTime, ResampleTime take
// tracks of one clip.
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "body_axes.h"
#include "pleat/skeleton/pose_track.h"

namespace pleat {

// kResourceExhausted when the result would have more than kMaxEditedFrames; kInvalidArgument says
// what else an edit cannot do.

// The duration times `factor`, at the same frame rate; each clip on its own.
absl::StatusOr<PoseTrack> ScaleTime(const PoseTrack& track, double factor);
// The same motion at another frame rate.
absl::StatusOr<PoseTrack> ResampleTime(const PoseTrack& track, double fps);
// What was at from[i] comes at to[i] (seconds, both ascending), and between them along a monotone
// cubic (Fritsch and Carlson 1980). What is before to[0] and after the last one is left out.
absl::StatusOr<PoseTrack> WarpTime(const PoseTrack& track, const std::vector<double>& from,
                                   const std::vector<double>& to);
absl::StatusOr<PoseTrack> TrimTime(const PoseTrack& track, double from_seconds, double to_seconds);
// The last `blend_seconds` lead into the first pose; then so many rounds follow each other, each
// from where the one before has come to on the ground.
absl::StatusOr<PoseTrack> LoopTrack(const PoseTrack& track, double blend_seconds, int count,
                                    const BodyAxes& axes);
// Moves `joints` of `track` by `weight` towards `other`, which is stretched to the same duration
// and begins at the same place on the ground with the same facing.
absl::StatusOr<PoseTrack> BlendTracks(const PoseTrack& track, const PoseTrack& other,
                                      const std::vector<int>& joints, double weight,
                                      const BodyAxes& axes);
// `other` begins where `track` is on the ground `blend_seconds` before its end; over this time one
// becomes the other.
absl::StatusOr<PoseTrack> ConcatenateTracks(const PoseTrack& track, const PoseTrack& other,
                                            double blend_seconds, const BodyAxes& axes);

}  // namespace pleat
