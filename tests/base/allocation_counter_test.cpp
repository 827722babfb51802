#include "support/allocation_counter.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <memory>
#include <vector>

namespace pleat {
namespace {

class AllocationCounterTest : public testing::Test {
 protected:
  void SetUp() override {
    if (NumAllocations() < 0) GTEST_SKIP() << "allocations cannot be counted in this build";
  }
};

TEST_F(AllocationCounterTest, SeesAVector) {
  const long before = NumAllocations();
  std::vector<double> values(1000);
  EXPECT_GT(NumAllocations(), before) << values.data();
}

TEST_F(AllocationCounterTest, SeesAnAlignedBlock) {
  const long before = NumAllocations();
  const std::unique_ptr<void, decltype(&free)> block(aligned_alloc(64, 640), &free);
  EXPECT_GT(NumAllocations(), before) << block.get();
}

TEST_F(AllocationCounterTest, SeesAGrowingBlock) {
  void* block = calloc(10, 10);
  const long before = NumAllocations();
  block = realloc(block, 100'000);
  EXPECT_GT(NumAllocations(), before) << block;
  free(block);
}

}  // namespace
}  // namespace pleat
