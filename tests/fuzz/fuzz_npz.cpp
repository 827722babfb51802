#include <cstddef>
#include <cstdint>
#include <string_view>
#include <utility>

#include "pleat/formats/npz.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  pleat::MeshLimits limits;
  limits.max_vertices = limits.max_faces = 20'000;
  limits.max_frames = 500;
  limits.max_sequence_bytes = limits.max_document_bytes = 50'000'000;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  auto contents = pleat::DecodeNpz(bytes, "fuzz.npz", {}, limits);
  if (!contents.ok() || !contents->topology) return 0;
  // What was read can be written and comes back.
  const auto sequence =
      pleat::MeshSequence::Create(*contents->topology, std::move(contents->frames));
  if (!sequence.ok()) return 0;
  const auto back = pleat::DecodeNpz(pleat::EncodeNpz(*sequence), "back.npz");
  if (!back.ok() || *back->topology != sequence->topology()) __builtin_trap();
  return 0;
}
