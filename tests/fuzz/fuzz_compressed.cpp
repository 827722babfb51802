#include <cstddef>
#include <cstdint>
#include <string>

#include "pleat/sequence_codec/sequence_decoder.h"
#include "sequence_codec/compressed_clip.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  // With the right checksums, so that the fuzzer gets behind them.
  pleat::MeshLimits limits;
  limits.max_vertices = limits.max_faces = 20'000;
  limits.max_frames = 500;
  limits.max_field_bytes = 100'000'000;
  auto decoder = pleat::SequenceDecoder::Open(
      pleat::ResealSections({reinterpret_cast<const char*>(data), size}), limits);
  if (decoder.ok()) decoder->DecodeAll().IgnoreError();
  return 0;
}
