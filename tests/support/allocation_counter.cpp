// Replaces the allocation functions of glibc by ones that count, as its manual allows ("Replacing
// malloc"). It is linked into the tests that ask for it and into nothing else.
#include "support/allocation_counter.h"

#include <errno.h>
#include <stdlib.h>

#include <atomic>

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define PLEAT_COUNT_ALLOCATIONS 1
#endif
#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#undef PLEAT_COUNT_ALLOCATIONS
#endif
#endif

#ifdef PLEAT_COUNT_ALLOCATIONS
namespace {

std::atomic<long> num_allocations{0};

void Count() { num_allocations.fetch_add(1, std::memory_order_relaxed); }

}  // namespace

extern "C" {
// What the replaced functions would have done.
void* __libc_malloc(size_t size);
void* __libc_calloc(size_t count, size_t size);
void* __libc_realloc(void* memory, size_t size);
void* __libc_memalign(size_t alignment, size_t size);

void* malloc(size_t size) {
  Count();
  return __libc_malloc(size);
}
void* calloc(size_t count, size_t size) {
  Count();
  return __libc_calloc(count, size);
}
void* realloc(void* memory, size_t size) {
  Count();
  return __libc_realloc(memory, size);
}
void* aligned_alloc(size_t alignment, size_t size) {
  Count();
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** memory, size_t alignment, size_t size) {
  Count();
  *memory = __libc_memalign(alignment, size);
  return *memory == nullptr ? ENOMEM : 0;
}
}  // extern "C"

long pleat::NumAllocations() { return num_allocations.load(); }
#else
long pleat::NumAllocations() { return -1; }
#endif
