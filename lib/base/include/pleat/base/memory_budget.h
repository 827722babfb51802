// The bytes that all calls of one kind may use together.
#pragma once

#include <cstdint>
#include <mutex>
#include <string>
#include <utility>

#include "absl/status/statusor.h"

namespace pleat {

class MemoryBudget;

// Bytes of a budget that are given back when the reservation is destroyed. The budget must outlive
// it. A reservation made by default holds none.
class Reservation {
 public:
  Reservation() = default;
  Reservation(MemoryBudget* budget, uint64_t bytes) : budget_(budget), bytes_(bytes) {}
  Reservation(Reservation&& other) noexcept
      : budget_(std::exchange(other.budget_, nullptr)), bytes_(other.bytes_) {}
  Reservation& operator=(Reservation&& other) noexcept {
    std::swap(budget_, other.budget_);
    std::swap(bytes_, other.bytes_);
    return *this;
  }
  ~Reservation();

  uint64_t bytes() const { return budget_ == nullptr ? 0 : bytes_; }
  // Gives back what is above `bytes`.
  void ShrinkTo(uint64_t bytes);

 private:
  MemoryBudget* budget_ = nullptr;
  uint64_t bytes_ = 0;
};

// Thread-safe.
class MemoryBudget {
 public:
  // flag: the option that sets the capacity, named in messages.
  MemoryBudget(uint64_t capacity_bytes, std::string flag)
      : capacity_bytes_(capacity_bytes), flag_(std::move(flag)) {}

  // Never waits: kResourceExhausted names `what` and the numbers when the bytes do not fit now.
  absl::StatusOr<Reservation> Reserve(uint64_t bytes, const std::string& what);
  uint64_t used_bytes() const;

 private:
  friend class Reservation;
  const uint64_t capacity_bytes_;
  const std::string flag_;
  mutable std::mutex mutex_;
  uint64_t used_bytes_ = 0;  // guarded by mutex_; at most capacity_bytes_
};

}  // namespace pleat
