#include "pleat/math/clip_starts.h"

#include <algorithm>
#include <cassert>

#include "absl/strings/str_cat.h"

namespace pleat {

absl::Status CheckClipStarts(const std::vector<int>& clip_starts, int64_t num_frames) {
  if (clip_starts.empty()) {
    return absl::InvalidArgumentError("'clip_starts' is empty; clip starts begin with frame 0");
  }
  for (size_t c = 0; c < clip_starts.size(); ++c) {
    const bool ascends = c == 0 ? clip_starts[c] == 0 : clip_starts[c] > clip_starts[c - 1];
    if (ascends && clip_starts[c] < num_frames) continue;
    return absl::InvalidArgumentError(
        absl::StrCat("entry ", c, " of 'clip_starts' is ", clip_starts[c],
                     "; clip starts ascend from 0 and stay below the ", num_frames, " frames"));
  }
  return absl::OkStatus();
}

ClipRange ClipOfFrame(const std::vector<int>& clip_starts, int num_frames, int t) {
  assert(!clip_starts.empty() && t >= 0 && t < num_frames);
  const auto next = std::upper_bound(clip_starts.begin(), clip_starts.end(), t);
  return {.clip = static_cast<int>(next - clip_starts.begin()) - 1,
          .begin = *(next - 1),
          .end = next == clip_starts.end() ? num_frames : *next};
}

std::vector<ClipRange> ClipRanges(const std::vector<int>& clip_starts, int num_frames) {
  std::vector<ClipRange> ranges;
  for (const int start : clip_starts) ranges.push_back(ClipOfFrame(clip_starts, num_frames, start));
  return ranges;
}

}  // namespace pleat
