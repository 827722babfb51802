#include "pleat/base/large_page_allocator.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <new>
#include <numeric>
#include <utility>
#include <vector>

namespace pleat {
namespace {

using Allocator = LargePageAllocator<int>;

TEST(LargePageAllocatorTest, ShortTablesBeginOnACacheLineLongOnesOnALargePage) {
  constexpr size_t kLong = Allocator::kLargePageBytes / sizeof(int);
  for (const size_t count : {size_t{1}, size_t{1000}, kLong - 1, kLong, 3 * kLong + 17}) {
    std::vector<int, Allocator> table(count);
    const size_t alignment =
        count < kLong ? Allocator::kCacheLineBytes : Allocator::kLargePageBytes;
    EXPECT_EQ(reinterpret_cast<uintptr_t>(table.data()) % alignment, 0u) << count;
    std::iota(table.begin(), table.end(), 0);
    EXPECT_EQ(table.back(), static_cast<int>(count) - 1);
  }
}

TEST(LargePageAllocatorTest, ContainersCopyMoveAndGrow) {
  std::vector<int, Allocator> table;
  for (int i = 0; i < 1 << 20; ++i) table.push_back(i);
  const std::vector<int, Allocator> copy = table;
  const std::vector<int, Allocator> moved = std::move(table);
  EXPECT_EQ(copy, moved);
  EXPECT_EQ(copy[123456], 123456);
}

TEST(LargePageAllocatorTest, RefusesWhatNoMemoryHolds) {
  Allocator allocator;
  EXPECT_THROW((void)allocator.allocate(static_cast<size_t>(-1) / 2), std::bad_array_new_length);
}

}  // namespace
}  // namespace pleat
