// Memory that is aligned to no register, with guards on both sides.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace pleat {

template <typename T>
class GuardedBuffer {
 public:
  explicit GuardedBuffer(size_t count, T value = T()) : GuardedBuffer(std::vector(count, value)) {}
  explicit GuardedBuffer(const std::vector<T>& content) : values_(kGuards, kGuard) {
    values_.insert(values_.end(), content.begin(), content.end());
    values_.insert(values_.end(), kGuards, kGuard);
  }

  T* data() { return values_.data() + kGuards; }
  const T* data() const { return values_.data() + kGuards; }
  std::vector<T> content() const { return {values_.begin() + kGuards, values_.end() - kGuards}; }
  bool intact() const {
    const auto is_guard = [](T value) { return value == kGuard; };
    return std::all_of(values_.begin(), values_.begin() + kGuards, is_guard) &&
           std::all_of(values_.end() - kGuards, values_.end(), is_guard);
  }

 private:
  static constexpr ptrdiff_t kGuards = 17;  // odd, so that data() is not aligned
  static constexpr T kGuard = 77;
  std::vector<T> values_;
};

}  // namespace pleat
