#include "pleat/base/memory_budget.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <thread>
#include <vector>

#include "pleat/base/limit_refusal.h"
#include "support/status_matchers.h"

namespace pleat {
namespace {

using ::testing::_;

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

TEST(MemoryBudgetTest, AParentBoundsItsChildrenTogether) {
  MemoryBudget all(100, "--memory-bytes");
  MemoryBudget decoders(80, "--decode-bytes", &all), jobs(100, "--memory-bytes", &all);
  {
    PLEAT_ASSERT_OK_AND_ASSIGN(Reservation one, decoders.Reserve(60, "one"));
    PLEAT_ASSERT_OK_AND_ASSIGN(const Reservation two, jobs.Reserve(30, "two"));
    EXPECT_EQ(all.used_bytes(), 90u);
    EXPECT_TRUE(jobs.Fits(10));
    EXPECT_FALSE(jobs.Fits(11));
    EXPECT_THAT(jobs.Reserve(11, "three"), HasStatus(absl::StatusCode::kResourceExhausted,
                                                     "three needs 11 bytes of memory, but 90 of "
                                                     "100 (--memory-bytes) are in use; try again "
                                                     "later"));
    EXPECT_EQ(jobs.used_bytes(), 30u);  // a refusal takes nothing anywhere
    one.ShrinkTo(10);
    EXPECT_EQ(all.used_bytes(), 40u);
    EXPECT_THAT(jobs.Reserve(60, "three"), IsOk());
  }
  EXPECT_EQ(all.used_bytes(), 0u);
  EXPECT_EQ(decoders.used_bytes(), 0u);
}

TEST(MemoryBudgetTest, ARefusalSaysWhetherWaitingHelps) {
  MemoryBudget all(100, "--memory-bytes");
  MemoryBudget decoders(80, "--decode-bytes", &all);
  PLEAT_ASSERT_OK_AND_ASSIGN(const Reservation one, decoders.Reserve(60, "one"));
  const auto later = LimitRefusalOf(decoders.Reserve(30, "x").status());
  ASSERT_TRUE(later);
  EXPECT_EQ(later->limit, "--decode-bytes");
  EXPECT_EQ(later->retry_after, absl::Seconds(1));
  const auto never = LimitRefusalOf(decoders.Reserve(81, "x").status());
  ASSERT_TRUE(never);
  EXPECT_FALSE(never->retry_after);
  EXPECT_TRUE(decoders.CanFit(80));
  EXPECT_FALSE(decoders.CanFit(81));
}

TEST(MemoryBudgetTest, WhatNobodyNeedsIsGivenBackBeforeAReservationIsRefused) {
  MemoryBudget all(100, "--memory-bytes");
  MemoryBudget kept(100, "--memory-bytes", &all), jobs(100, "--memory-bytes", &all);
  Reservation first = kept.Reserve(50, "kept").value(), second = kept.Reserve(40, "kept").value();
  std::vector<uint64_t> asked;
  kept.AddReclaimer([&](uint64_t bytes) {
    asked.push_back(bytes);
    first = Reservation();
  });
  kept.AddReclaimer([&](uint64_t bytes) {
    asked.push_back(bytes);
    second = Reservation();
  });
  EXPECT_THAT(jobs.ReserveUnused(20, "polite"), HasStatus(absl::StatusCode::kResourceExhausted, _));
  EXPECT_TRUE(asked.empty());
  PLEAT_ASSERT_OK_AND_ASSIGN(const Reservation job, jobs.Reserve(55, "a job"));
  EXPECT_THAT(asked, testing::ElementsAre(55u));  // the first one was enough
  PLEAT_ASSERT_OK_AND_ASSIGN(const Reservation other, jobs.Reserve(45, "another"));
  EXPECT_THAT(asked, testing::ElementsAre(55u, 45u, 45u));
  EXPECT_THAT(jobs.Reserve(101, "too large"), HasStatus(absl::StatusCode::kResourceExhausted, _));
  EXPECT_EQ(asked.size(), 3u);  // what can never fit asks nobody
}

TEST(MemoryBudgetTest, WhoeverWaitsIsWokenByARelease) {
  MemoryBudget all(100, "--memory-bytes");
  MemoryBudget jobs(100, "--memory-bytes", &all);
  std::optional<Reservation> held = all.Reserve(80, "held").value();
  std::thread waiting([&] {
    while (true) {
      const uint64_t seen = jobs.num_releases();
      if (jobs.Fits(50)) return;
      jobs.WaitForRelease(seen, absl::Hours(1));
    }
  });
  held.reset();
  waiting.join();
  EXPECT_EQ(all.used_bytes(), 0u);
}

}  // namespace
}  // namespace pleat
