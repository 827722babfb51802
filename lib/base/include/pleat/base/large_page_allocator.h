// Memory for large tables that are read from front to back, once per query.
#pragma once

#include <cstddef>
#include <new>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace pleat {

// An allocator for standard containers. Memory of at least the length of a large page begins on one
// and asks the system for large pages: a table that fell out of the caches comes back faster, since
// the processor has to translate hundreds of addresses fewer. Shorter memory begins on a cache
// line.
template <typename T>
struct LargePageAllocator {
  using value_type = T;

  static constexpr size_t kLargePageBytes = size_t{2} << 20, kCacheLineBytes = 64;
  static constexpr std::align_val_t AlignmentOf(size_t count) {
    return std::align_val_t(count * sizeof(T) < kLargePageBytes ? kCacheLineBytes
                                                                : kLargePageBytes);
  }

  LargePageAllocator() = default;
  template <typename Other>
  LargePageAllocator(const LargePageAllocator<Other>&) {}  // NOLINT: containers convert

  T* allocate(size_t count) {
    if (count > static_cast<size_t>(-1) / sizeof(T)) throw std::bad_array_new_length();
    void* memory = ::operator new(count * sizeof(T), AlignmentOf(count));
#if defined(__linux__)
    // Only whole pages are asked for, since the rest would cost memory. A system without large
    // pages refuses, which changes nothing but the speed.
    if (const size_t bytes = count * sizeof(T) / kLargePageBytes * kLargePageBytes; bytes > 0) {
      madvise(memory, bytes, MADV_HUGEPAGE);
    }
#endif
    return static_cast<T*>(memory);
  }
  // The alignment follows from `count`, which a container passes back as it was given to
  // allocate().
  void deallocate(T* memory, size_t count) { ::operator delete(memory, AlignmentOf(count)); }

  friend bool operator==(const LargePageAllocator&, const LargePageAllocator&) { return true; }
};

}  // namespace pleat
