// Clips: runs of consecutive frames (or rows) of one recording, given by the first frame of each.
#pragma once

#include <cstdint>
#include <vector>

#include "absl/status/status.h"

namespace pleat {

// OK when the first entry is 0 and the entries ascend strictly and stay below `num_frames`;
// kInvalidArgument names the first entry that is wrong.
absl::Status CheckClipStarts(const std::vector<int>& clip_starts, int64_t num_frames);

// The clip of frame t is number `clip`, with the frames [begin, end).
struct ClipRange {
  int clip = 0;
  int begin = 0, end = 0;
};
// clip_starts: valid for `num_frames`, which is above t.
ClipRange ClipOfFrame(const std::vector<int>& clip_starts, int num_frames, int t);
// All clips in order.
std::vector<ClipRange> ClipRanges(const std::vector<int>& clip_starts, int num_frames);

}  // namespace pleat
