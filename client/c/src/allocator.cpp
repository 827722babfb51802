// Memory for tables and matrices: Eigen takes it with malloc, large tables with an aligned operator
// new (pleat/base/large_page_allocator.h). Neither ever crosses to another library, so both can go
// to the allocator of the host. Plain operator new cannot: strings that one library allocates are
// freed by another one. The linker sends the calls here (--wrap, client/c/CMakeLists.txt), and the
// version script keeps the operators inside the library, so the host's own memory is not touched.
#include <atomic>
#include <cstdlib>
#include <cstring>
#include <new>

#include "error_report.h"
#include "pleat/base/status.h"

extern "C" {
void* __real_malloc(size_t size);                 // NOLINT: the names are the linker's
void* __real_calloc(size_t count, size_t size);   // NOLINT
void* __real_realloc(void* memory, size_t size);  // NOLINT
void __real_free(void* memory);                   // NOLINT
}

namespace pleat {
namespace {

// Where memory comes from. It is decided once, by the first allocation or by the caller.
enum class Source { kUndecided, kLibrary, kCaller };
std::atomic<Source> source{Source::kUndecided};
pleat_allocator caller;  // valid when the source is kCaller

bool FromCaller() {
  Source now = source.load(std::memory_order_acquire);
  if (now == Source::kUndecided &&
      source.compare_exchange_strong(now, Source::kLibrary, std::memory_order_acq_rel)) {
    return false;
  }
  return now == Source::kCaller;
}

// What malloc promises. In front of the memory stands its size, which realloc needs.
constexpr size_t kAlignment = alignof(std::max_align_t);

void* AllocateSized(size_t size) {
  if (size > static_cast<size_t>(-1) - kAlignment) return nullptr;
  void* const memory = caller.allocate(caller.user, size + kAlignment, kAlignment);
  if (memory == nullptr) return nullptr;
  std::memcpy(memory, &size, sizeof(size));
  return static_cast<char*>(memory) + kAlignment;
}

void DeallocateSized(void* memory) {
  if (memory != nullptr) {
    caller.deallocate(caller.user, static_cast<char*>(memory) - kAlignment);
  }
}

void* ReallocateSized(void* memory, size_t size) {
  if (memory == nullptr) return AllocateSized(size);
  size_t size_before = 0;
  std::memcpy(&size_before, static_cast<char*>(memory) - kAlignment, sizeof(size_before));
  void* const moved = AllocateSized(size);
  if (moved == nullptr) return nullptr;
  std::memcpy(moved, memory, size < size_before ? size : size_before);
  DeallocateSized(memory);
  return moved;
}

void* AllocateAligned(size_t size, size_t alignment) {
  if (FromCaller()) return caller.allocate(caller.user, size == 0 ? 1 : size, alignment);
  if (size > static_cast<size_t>(-1) - alignment) return nullptr;
  return std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
}

void DeallocateAligned(void* memory) {
  if (memory == nullptr) return;
  FromCaller() ? caller.deallocate(caller.user, memory) : __real_free(memory);
}

}  // namespace
}  // namespace pleat

extern "C" {

void* __wrap_malloc(size_t size) {  // NOLINT
  return pleat::FromCaller() ? pleat::AllocateSized(size) : __real_malloc(size);
}

// The compiler makes it of malloc and memset.
void* __wrap_calloc(size_t count, size_t size) {  // NOLINT
  if (!pleat::FromCaller()) return __real_calloc(count, size);
  if (size > 0 && count > static_cast<size_t>(-1) / size) return nullptr;
  void* const memory = pleat::AllocateSized(count * size);
  return memory == nullptr ? nullptr : std::memset(memory, 0, count * size);
}

void* __wrap_realloc(void* memory, size_t size) {  // NOLINT
  return pleat::FromCaller() ? pleat::ReallocateSized(memory, size) : __real_realloc(memory, size);
}

void __wrap_free(void* memory) {  // NOLINT
  pleat::FromCaller() ? pleat::DeallocateSized(memory) : __real_free(memory);
}

pleat_code pleat_set_allocator(const pleat_allocator* allocator, pleat_error* error) {
  return pleat::Guarded(error, [&]() -> absl::Status {
    if (allocator == nullptr) return pleat::IsNull("allocator");
    PLEAT_RETURN_IF_ERROR(
        pleat::CheckStructSize("pleat_allocator", allocator->struct_size, sizeof(pleat_allocator)));
    if (allocator->allocate == nullptr || allocator->deallocate == nullptr) {
      return pleat::IsNull("a function of the allocator");
    }
    if (pleat::source.load() == pleat::Source::kUndecided) {
      pleat::caller = *allocator;
      pleat::Source expected = pleat::Source::kUndecided;
      if (pleat::source.compare_exchange_strong(expected, pleat::Source::kCaller)) {
        return absl::OkStatus();
      }
    }
    return absl::FailedPreconditionError(
        "the library has taken memory already: set the allocator before anything else, once");
  });
}

}  // extern "C"

void* operator new(size_t size, std::align_val_t alignment) {
  void* const memory = pleat::AllocateAligned(size, static_cast<size_t>(alignment));
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}
void* operator new[](size_t size, std::align_val_t alignment) {
  return operator new(size, alignment);
}
void operator delete(void* memory, std::align_val_t) noexcept { pleat::DeallocateAligned(memory); }
void operator delete[](void* memory, std::align_val_t) noexcept {
  pleat::DeallocateAligned(memory);
}
void operator delete(void* memory, size_t, std::align_val_t) noexcept {
  pleat::DeallocateAligned(memory);
}
void operator delete[](void* memory, size_t, std::align_val_t) noexcept {
  pleat::DeallocateAligned(memory);
}
