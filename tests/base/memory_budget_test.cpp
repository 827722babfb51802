#include "pleat/base/memory_budget.h"

#include <gtest/gtest.h>

#include <optional>
#include <thread>
#include <vector>

#include "support/status_matchers.h"

namespace pleat {
namespace {

TEST(MemoryBudgetTest, WhatIsReservedComesBackWithItsReservation) {
  MemoryBudget budget(100, "--bytes");
  {
    PLEAT_ASSERT_OK_AND_ASSIGN(const Reservation sixty, budget.Reserve(60, "one"));
    EXPECT_EQ(budget.used_bytes(), 60u);
    EXPECT_THAT(budget.Reserve(41, "another"),
                HasStatus(absl::StatusCode::kResourceExhausted,
                          "another needs 41 bytes of memory, but 60 of 100 (--bytes) are in use; "
                          "try again later"));
    EXPECT_EQ(budget.used_bytes(), 60u);
    PLEAT_ASSERT_OK_AND_ASSIGN(const Reservation forty, budget.Reserve(40, "the rest"));
    EXPECT_THAT(budget.Reserve(0, "nothing"), IsOk());
    EXPECT_FALSE(budget.Reserve(1, "more").ok());
  }
  EXPECT_EQ(budget.used_bytes(), 0u);
}

TEST(MemoryBudgetTest, SizesThatWouldOverflowAreRefused) {
  MemoryBudget budget(100, "--bytes");
  PLEAT_ASSERT_OK_AND_ASSIGN(const Reservation some, budget.Reserve(10, "some"));
  for (const uint64_t bytes : {~uint64_t{0}, ~uint64_t{0} - 9, uint64_t{91}}) {
    EXPECT_THAT(budget.Reserve(bytes, "x"),
                HasStatus(absl::StatusCode::kResourceExhausted, testing::_));
  }
  EXPECT_EQ(budget.used_bytes(), 10u);
  EXPECT_FALSE(MemoryBudget(0, "--none").Reserve(1, "x").ok());
}

TEST(MemoryBudgetTest, AReservationMovesAndIsGivenBackOnce) {
  MemoryBudget budget(100, "--bytes");
  Reservation kept;
  {
    Reservation first = budget.Reserve(30, "a").value();
    Reservation moved = std::move(first);
    kept = std::move(moved);
  }
  EXPECT_EQ(budget.used_bytes(), 30u);
  Reservation second = budget.Reserve(50, "b").value();
  kept = std::move(second);  // takes 50, and the 30 go with `second`
  second = Reservation();
  EXPECT_EQ(budget.used_bytes(), 50u);
  kept = Reservation();
  EXPECT_EQ(budget.used_bytes(), 0u);
}

TEST(MemoryBudgetTest, ManyThreadsNeverTakeMoreThanThereIs) {
  constexpr uint64_t kCapacity = 1000;
  MemoryBudget budget(kCapacity, "--bytes");
  std::vector<std::thread> threads;
  for (uint64_t thread = 1; thread <= 4; ++thread) {
    threads.emplace_back([&, thread] {
      for (int i = 0; i < 2000; ++i) {
        const absl::StatusOr<Reservation> taken = budget.Reserve(100 * thread, "x");
        EXPECT_LE(budget.used_bytes(), kCapacity);
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(budget.used_bytes(), 0u);
}

TEST(MemoryBudgetTest, AReservationCanShrinkAndNeverGrows) {
  MemoryBudget budget(100, "--bytes");
  PLEAT_ASSERT_OK_AND_ASSIGN(Reservation reservation, budget.Reserve(60, "one"));
  reservation.ShrinkTo(20);
  EXPECT_EQ(budget.used_bytes(), 20u);
  reservation.ShrinkTo(50);
  EXPECT_EQ(reservation.bytes(), 20u);
  reservation = Reservation();
  EXPECT_EQ(budget.used_bytes(), 0u);
  reservation.ShrinkTo(0);  // of nothing
}

}  // namespace
}  // namespace pleat
