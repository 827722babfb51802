#include "pleat/base/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <vector>

namespace pleat {
namespace {

class ParallelForTest : public testing::TestWithParam<int> {};

TEST_P(ParallelForTest, RunsEachItemOnce) {
  std::vector<int> runs(1000, 0);
  ParallelFor(1000, GetParam(), [&](int item) { ++runs[item]; });
  EXPECT_EQ(runs, std::vector<int>(1000, 1));
}

TEST_P(ParallelForTest, RethrowsAfterAllThreadsEnded) {
  std::atomic<int> running{0};
  EXPECT_THROW(ParallelFor(100, GetParam(),
                           [&](int item) {
                             ++running;
                             if (item == 40) {
                               --running;
                               throw std::runtime_error("item 40");
                             }
                             --running;
                           }),
               std::runtime_error);
  EXPECT_EQ(running, 0);
}

INSTANTIATE_TEST_SUITE_P(Threads, ParallelForTest, testing::Values(0, 1, 2, 7));

TEST_P(ParallelForTest, PiecesCoverEveryItemOnce) {
  std::vector<std::atomic<int>> counts(1003);
  EXPECT_TRUE(
      ParallelForPieces(1003, 64, GetParam(), Progress(), [&](int item) { ++counts[item]; }).ok());
  for (const std::atomic<int>& count : counts) EXPECT_EQ(count, 1);
}

TEST_P(ParallelForTest, NoPieceBeginsAfterACancellation) {
  const Progress cancelled(nullptr, [] { return true; });
  EXPECT_EQ(ParallelForPieces(10, 3, GetParam(), cancelled, [](int) { FAIL(); }).code(),
            absl::StatusCode::kCancelled);
}

TEST(ParallelForTest, NoItemsIsFine) {
  ParallelFor(0, 4, [](int) { FAIL(); });
}

}  // namespace
}  // namespace pleat
