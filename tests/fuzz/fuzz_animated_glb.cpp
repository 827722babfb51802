#include <cstddef>
#include <cstdint>
#include <string_view>

#include "gltf_sequence.h"
#include "pleat/formats/glb_writer.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  pleat::ReadSequenceOptions options;
  options.limits.max_vertices = options.limits.max_faces = 20'000;
  options.limits.max_frames = 200;
  options.limits.max_sequence_bytes = 10'000'000;
  const pleat::Progress progress;
  pleat::InputReport report;
  const auto sequence =
      pleat::DecodeGlbAnimation(std::string_view(reinterpret_cast<const char*>(data), size),
                                "fuzz.glb", {options, progress, &report});
  if (!sequence.ok() || !*sequence || (*sequence)->num_frames() < 2) return 0;
  // What was read can be written and comes back.
  const auto bytes = pleat::EncodeGlb(**sequence);
  if (!bytes.ok()) return 0;
  pleat::ReadSequenceOptions all;
  const auto back = pleat::DecodeGlbAnimation(*bytes, "back.glb", {all, progress, &report});
  if (!back.ok() || !*back || (*back)->num_frames() != (*sequence)->num_frames()) __builtin_trap();
  return 0;
}
