#include "free_numbers.h"

#include <gtest/gtest.h>

#include "pleat/base/random.h"

namespace pleat {
namespace {

// The same by looking at every number.
class SlowFreeNumbers {
 public:
  explicit SlowFreeNumbers(int count) : free_(count, true) {}

  int Rank(int number) const {
    return static_cast<int>(std::count(free_.begin(), free_.begin() + number, true));
  }
  int Select(int rank, bool free) const {
    for (size_t i = 0; i < free_.size(); ++i) {
      if (free_[i] == free && rank-- == 0) return static_cast<int>(i);
    }
    return -1;
  }
  int num_free() const { return Rank(static_cast<int>(free_.size())); }
  bool is_free(int number) const { return free_[number]; }
  void Set(int number, bool free) { free_[number] = free; }

 private:
  std::vector<bool> free_;
};

TEST(FreeNumbersTest, AgreesWithALinearSearchForEveryCountAndHistory) {
  Random random(1);
  for (const int count : {1, 2, 3, 7, 8, 9, 63, 64, 65, 200}) {
    FreeNumbers numbers(count);
    SlowFreeNumbers slow(count);
    for (int step = 0; step < 300; ++step) {
      const int number = random.UniformInt(count);
      if (slow.is_free(number)) {
        numbers.Take(number);
      } else {
        numbers.Return(number);
      }
      slow.Set(number, !slow.is_free(number));
      ASSERT_EQ(numbers.num_free(), slow.num_free());
      ASSERT_EQ(numbers.num_taken(), count - slow.num_free());
      const int probe = random.UniformInt(count);
      ASSERT_EQ(numbers.Rank(probe), slow.Rank(probe)) << count << " " << step;
      if (numbers.num_free() > 0) {
        const int rank = random.UniformInt(numbers.num_free());
        ASSERT_EQ(numbers.Select(rank), slow.Select(rank, true)) << count << " " << step;
      }
      if (numbers.num_taken() > 0) {
        const int rank = random.UniformInt(numbers.num_taken());
        ASSERT_EQ(numbers.SelectTaken(rank), slow.Select(rank, false)) << count << " " << step;
      }
    }
  }
}

TEST(FreeNumbersTest, RankAndSelectAreInverse) {
  FreeNumbers numbers(100);
  for (int i = 0; i < 100; i += 3) numbers.Take(i);
  for (int rank = 0; rank < numbers.num_free(); ++rank) {
    EXPECT_EQ(numbers.Rank(numbers.Select(rank)), rank);
  }
}

TEST(FreeNumbersTest, NoNumbersAtAll) {
  const FreeNumbers numbers(0);
  EXPECT_EQ(numbers.num_free(), 0);
  EXPECT_EQ(numbers.num_taken(), 0);
  EXPECT_EQ(numbers.Rank(0), 0);
}

}  // namespace
}  // namespace pleat
