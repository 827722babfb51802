// First in, first out, without an allocation once the queue has been as long as it gets.
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace pleat {

// Elements stay in their slots when they are taken out, and the memory they own is used again. Not
// thread-safe.
template <typename T>
class RingQueue {
 public:
  RingQueue() = default;
  // One slot for each element of `slots`, whose memory the first elements will use.
  explicit RingQueue(std::vector<T> slots) : slots_(std::move(slots)) {}

  bool empty() const { return size_ == 0; }
  size_t size() const { return size_; }
  T& front() { return slots_[first_]; }
  T& back() { return slots_[(first_ + size_ - 1) % slots_.size()]; }

  // A new last element for the caller to overwrite: it holds what an earlier one has left behind.
  T& PushBack() {
    if (size_ == slots_.size()) Grow();
    ++size_;
    return back();
  }
  void PopFront() {
    first_ = (first_ + 1) % slots_.size();
    --size_;
  }

 private:
  void Grow() {
    std::rotate(slots_.begin(), slots_.begin() + static_cast<ptrdiff_t>(first_), slots_.end());
    first_ = 0;
    slots_.resize(std::max(size_t{4}, 2 * slots_.size()));
  }

  std::vector<T> slots_;
  size_t first_ = 0, size_ = 0;
};

}  // namespace pleat
