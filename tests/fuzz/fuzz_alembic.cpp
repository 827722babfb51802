#include <cstddef>
#include <cstdint>
#include <string_view>

#include "pleat/formats/alembic_reader.h"
#include "pleat/formats/alembic_writer.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  pleat::AlembicOptions options;
  options.limits.max_vertices = options.limits.max_faces = 20'000;
  options.limits.max_frames = 500;
  options.limits.max_sequence_bytes = 100'000'000;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const auto sequence = pleat::DecodeAlembic(bytes, "fuzz.abc", options);
  if (!sequence.ok()) return 0;
  // What was read can be written and comes back.
  const auto back = pleat::DecodeAlembic(pleat::EncodeAlembic(*sequence), "back.abc", options);
  if (!back.ok() || back->topology() != sequence->topology()) __builtin_trap();
  return 0;
}
