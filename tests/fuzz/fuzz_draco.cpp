// Draco's decoder is not resource-safe (that is why it runs in a process with limits), so memory is
// limited here as it is there: an allocation above the limit throws std::bad_alloc.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <new>
#include <string_view>

#include "pleat/stream/draco_file.h"

namespace {
constexpr size_t kMaxAllocationBytes = size_t{64} << 20;
}

void* operator new(size_t size, const std::nothrow_t&) noexcept {
  return size <= kMaxAllocationBytes ? std::malloc(size) : nullptr;
}
void* operator new(size_t size) {
  if (void* memory = operator new(size, std::nothrow)) return memory;
  throw std::bad_alloc();
}
void* operator new[](size_t size) { return operator new(size); }
void* operator new[](size_t size, const std::nothrow_t& tag) noexcept {
  return operator new(size, tag);
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, size_t) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory, size_t) noexcept { std::free(memory); }

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const auto geometry =
      pleat::DecodeDracoFile(std::string_view(reinterpret_cast<const char*>(data), size),
                             {.max_vertices = 2000, .max_faces = 4000});
  if (!geometry.ok()) return 0;
  if (geometry->triangles.size() > 0 &&
      (geometry->triangles.minCoeff() < 0 ||
       geometry->triangles.maxCoeff() >= geometry->positions.cols())) {
    __builtin_trap();
  }
  return 0;
}
