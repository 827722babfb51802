#include <cstddef>
#include <cstdint>
#include <string_view>

#include "pleat/formats/gltf_reader.h"

// Limits as small as the inputs: what a file unfolds to is tested elsewhere.
extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const pleat::MeshLimits limits = {.max_vertices = 10'000, .max_faces = 10'000};
  const auto mesh = pleat::DecodeGlb(std::string_view(reinterpret_cast<const char*>(data), size),
                                     "fuzz.glb", limits);
  if (!mesh.ok()) return 0;
  if (mesh->positions.cols() != mesh->topology.num_vertices()) __builtin_trap();
  if (!pleat::CheckAppearance(mesh->appearance, mesh->topology).ok()) __builtin_trap();
  return 0;
}
