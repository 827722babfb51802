// Which animation of a glTF file is read, and at which times.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
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

// The animation of that name, else of that number. kNotFound, with the names that there are, when
// it is none of them. An empty `wanted` takes the first animation with channels, none when there is
// none; a note says then which others there are.
absl::StatusOr<std::optional<GlbAnimation>> ChooseGlbAnimation(const GlbContainer& glb,
                                                               const GlbNodes& nodes,
                                                               std::string_view wanted,
                                                               InputReport* report);

}  // namespace pleat
