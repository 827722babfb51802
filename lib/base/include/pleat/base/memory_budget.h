// Bytes of memory that are promised before they are taken, by owner, within one number.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/time/time.h"

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

// Budgets form a tree: what is reserved of one is reserved of its parent as well, so the capacity
// of the root bounds all owners together, and that of a child bounds one of them. The root is what
// --memory-bytes sets.
//
// Memory that is kept for nobody in particular, such as models that no call uses, is charged like
// any other, but its owner offers a reclaimer: a reservation that does not fit asks for it back
// before it is refused. So the number bounds the process without keeping anybody from using it all.
//
// Thread-safe. No mutex of a budget is held while another one is taken or a reclaimer runs.
class MemoryBudget {
 public:
  // flag: the option that sets the capacity, named in messages. parent: null for the root; it must
  // outlive this one.
  MemoryBudget(uint64_t capacity_bytes, std::string flag, MemoryBudget* parent = nullptr)
      : capacity_bytes_(capacity_bytes), flag_(std::move(flag)), parent_(parent) {}
  MemoryBudget(const MemoryBudget&) = delete;
  MemoryBudget& operator=(const MemoryBudget&) = delete;

  // Never waits: kResourceExhausted (a LimitRefusal) names `what` and the numbers when the bytes do
  // not fit now, although reclaimers were asked.
  absl::StatusOr<Reservation> Reserve(uint64_t bytes, const std::string& what);
  // The same without asking anybody for memory, for callers that hold a lock which a reclaimer
  // takes.
  absl::StatusOr<Reservation> ReserveUnused(uint64_t bytes, const std::string& what);

  // Says whether so many bytes are unused now, here and above.
  bool Fits(uint64_t bytes) const;
  // Says whether they can ever fit.
  bool CanFit(uint64_t bytes) const;
  // How often bytes of the root were given back. Whoever wants to wait asks for it before the
  // attempt that fails, so that no release in between is missed.
  uint64_t num_releases();
  // Returns when there have been more than `num_seen`, at the latest after `timeout`.
  void WaitForRelease(uint64_t num_seen, absl::Duration timeout);

  // Frees about `bytes` that nobody needs, if it can. Called from any thread that reserves, without
  // a lock of any budget. Reclaimers stay as long as the budget, and are added before it is used.
  using Reclaimer = std::function<void(uint64_t bytes)>;
  // All reclaimers belong to the root.
  void AddReclaimer(Reclaimer reclaim);

  uint64_t used_bytes() const;
  uint64_t capacity_bytes() const { return capacity_bytes_; }

 private:
  friend class Reservation;
  MemoryBudget& root() { return parent_ == nullptr ? *this : parent_->root(); }
  // Reserves of this one and of all above, or of none.
  absl::Status Take(uint64_t bytes, const std::string& what);
  void Release(uint64_t bytes);  // of this one and of all above

  const uint64_t capacity_bytes_;
  const std::string flag_;
  MemoryBudget* const parent_;
  std::vector<Reclaimer> reclaimers_;
  mutable std::mutex mutex_;
  std::condition_variable released_;
  uint64_t used_bytes_ = 0;    // guarded by mutex_; at most capacity_bytes_
  uint64_t num_releases_ = 0;  // guarded by mutex_
};

}  // namespace pleat
