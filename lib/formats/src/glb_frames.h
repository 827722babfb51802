// Which animation of a glTF file is read, and at which times.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "glb_animation.h"
#include "glb_container.h"
#include "glb_nodes.h"
#include "pleat/mesh/input_note.h"

namespace pleat {

// When the frames are, and how many a second has.
struct GlbFrames {
  std::vector<float> times;
  FrameRate rate;
};

struct GlbFrameOptions {
  std::optional<FrameRate> frame_rate{};  // in place of that of the keys
  int64_t max_frames = 100'000;
};

// The keys themselves where they are evenly spaced; else the frames of a rate between the first key
// and the last. What was assumed is noted. The animation must have a channel.
GlbFrames ChooseGlbFrames(const GlbAnimation& animation, const GlbFrameOptions& options,
                          InputReport* report);

// The first animation with channels, none when there is none; a note says which others there are.
absl::StatusOr<std::optional<GlbAnimation>> ChooseGlbAnimation(const GlbContainer& glb,
                                                               const GlbNodes& nodes,
                                                               InputReport* report);

}  // namespace pleat
