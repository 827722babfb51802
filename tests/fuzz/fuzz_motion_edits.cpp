#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "pleat/formats/edited_motion_file.h"
#include "pleat/formats/vertex_channel.h"
#include "pleat/motion/apply_edits.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  (void)pleat::DecodeVertexChannel(text);
  const auto history = pleat::DecodeEditHistory(text);
  const auto skeleton = pleat::DecodeMotionSkeleton(text);
  if (!history.ok() || !skeleton.ok() || !skeleton->has_value()) return 0;
  // What can be computed can be edited further and undone again.
  const auto motion = pleat::ApplyHistory(**skeleton, *history);
  if (!motion.ok() || motion->track.num_frames() > 5000) return 0;
  const auto edited = pleat::AddEdit(**skeleton, text, {.kind = pleat::EditKind::kMirror});
  if (!edited.ok()) return 0;
  const auto back = pleat::UndoEdits(*edited, 1);
  if (!back.ok()) __builtin_trap();
  if (history->edits.empty() && *back != text) __builtin_trap();
  return 0;
}
