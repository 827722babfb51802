// Which of the numbers 0..n-1 are still free, with ranks (Fenwick 1994, binary indexed trees).
#pragma once

#include <cstdint>
#include <vector>

namespace pleat {

class FreeNumbers {
 public:
  explicit FreeNumbers(int count) : tree_(static_cast<size_t>(count) + 1), num_free_(count) {
    for (int i = 1; i <= count; ++i) tree_[i] = i & -i;
    while (top_ * 2 <= count) top_ *= 2;
  }

  int num_free() const { return num_free_; }
  int num_taken() const { return static_cast<int>(tree_.size()) - 1 - num_free_; }
  // Free numbers below `number`.
  int Rank(int number) const {
    int rank = 0;
    for (int i = number; i > 0; i -= i & -i) rank += tree_[i];
    return rank;
  }
  // The free number of that rank; 0 <= rank < num_free().
  int Select(int rank) const {
    int position = 0;
    for (int step = top_; step > 0; step /= 2) {
      if (position + step < static_cast<int>(tree_.size()) && tree_[position + step] <= rank) {
        position += step;
        rank -= tree_[position];
      }
    }
    return position;
  }
  // The number of that rank among those that are not free; 0 <= rank < num_taken().
  int SelectTaken(int rank) const {
    int position = 0;
    for (int step = top_; step > 0; step /= 2) {
      if (position + step < static_cast<int>(tree_.size()) &&
          step - tree_[position + step] <= rank) {
        position += step;
        rank -= step - tree_[position];
      }
    }
    return position;
  }
  // `number` must be free.
  void Take(int number) { Add(number, -1); }
  // `number` must not be free.
  void Return(int number) { Add(number, 1); }

 private:
  void Add(int number, int change) {
    for (int i = number + 1; i < static_cast<int>(tree_.size()); i += i & -i) tree_[i] += change;
    num_free_ += change;
  }

  std::vector<int32_t> tree_;
  int num_free_;
  int top_ = 1;
};

}  // namespace pleat
