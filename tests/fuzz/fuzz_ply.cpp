#include <cstddef>
#include <cstdint>
#include <string_view>

#include "pleat/formats/ply_reader.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const auto mesh =
      pleat::DecodePly(std::string_view(reinterpret_cast<const char*>(data), size), "fuzz.ply");
  if (mesh.ok() && mesh->positions.cols() != mesh->topology.num_vertices()) __builtin_trap();
  return 0;
}
