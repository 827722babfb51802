#include "allocation_counter.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <atomic>
#include <vector>

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
}  // namespace

// Eigen and operator new both end here.
extern "C" void* __libc_malloc(size_t size);
extern "C" void* malloc(size_t size) {
  num_allocations.fetch_add(1, std::memory_order_relaxed);
  return __libc_malloc(size);
}

long pleat::NumAllocations() { return num_allocations.load(); }
#else
long pleat::NumAllocations() { return -1; }
#endif

namespace pleat {
namespace {

TEST(AllocationCounterTest, SeesAnAllocation) {
  const long before = NumAllocations();
  if (before < 0) GTEST_SKIP() << "allocations cannot be counted in this build";
  std::vector<double> values(1000);
  EXPECT_GT(NumAllocations(), before) << values.data();
}

}  // namespace
}  // namespace pleat
