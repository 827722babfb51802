#include "pleat/base/memory_budget.h"

#include "absl/strings/str_cat.h"
#include "pleat/base/limit_refusal.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

// Nobody knows when the calls that use the memory will end; most of them take less.
constexpr absl::Duration kRetryAfter = absl::Seconds(1);

}  // namespace

Reservation::~Reservation() {
  if (budget_ != nullptr) budget_->Release(bytes_);
}

void Reservation::ShrinkTo(uint64_t bytes) {
  if (budget_ == nullptr || bytes >= bytes_) return;
  budget_->Release(bytes_ - bytes);
  bytes_ = bytes;
}

void MemoryBudget::Release(uint64_t bytes) {
  {
    std::lock_guard lock(mutex_);
    used_bytes_ -= bytes;
    ++num_releases_;
    // With the lock held: the budget may be gone as soon as whoever waits has seen the release.
    released_.notify_all();
  }
  if (parent_ != nullptr) parent_->Release(bytes);
}

absl::Status MemoryBudget::Take(uint64_t bytes, const std::string& what) {
  {
    std::lock_guard lock(mutex_);
    if (bytes > capacity_bytes_ - used_bytes_) {
      LimitRefusal refusal{.limit = flag_};
      if (bytes <= capacity_bytes_) refusal.retry_after = kRetryAfter;
      return RefuseForLimit(
          refusal,
          absl::StrCat(what, " needs ", bytes, " bytes of memory, but ", used_bytes_, " of ",
                       capacity_bytes_, " (", flag_, ") are in use; ",
                       refusal.retry_after ? "try again later" : "the operator must allow more"));
    }
    used_bytes_ += bytes;
  }
  if (parent_ == nullptr) return absl::OkStatus();
  absl::Status status = parent_->Take(bytes, what);
  if (!status.ok()) {
    std::lock_guard lock(mutex_);
    used_bytes_ -= bytes;
  }
  return status;
}

absl::StatusOr<Reservation> MemoryBudget::ReserveUnused(uint64_t bytes, const std::string& what) {
  PLEAT_RETURN_IF_ERROR(Take(bytes, what));
  return Reservation(this, bytes);
}

absl::StatusOr<Reservation> MemoryBudget::Reserve(uint64_t bytes, const std::string& what) {
  absl::StatusOr<Reservation> reservation = ReserveUnused(bytes, what);
  if (reservation.ok() || !CanFit(bytes)) return reservation;
  for (const Reclaimer& reclaim : root().reclaimers_) {
    reclaim(bytes);
    reservation = ReserveUnused(bytes, what);
    if (reservation.ok()) break;
  }
  return reservation;
}

bool MemoryBudget::Fits(uint64_t bytes) const {
  {
    std::lock_guard lock(mutex_);
    if (bytes > capacity_bytes_ - used_bytes_) return false;
  }
  return parent_ == nullptr || parent_->Fits(bytes);
}

bool MemoryBudget::CanFit(uint64_t bytes) const {
  return bytes <= capacity_bytes_ && (parent_ == nullptr || parent_->CanFit(bytes));
}

uint64_t MemoryBudget::num_releases() {
  MemoryBudget& top = root();
  std::lock_guard lock(top.mutex_);
  return top.num_releases_;
}

void MemoryBudget::WaitForRelease(uint64_t num_seen, absl::Duration timeout) {
  MemoryBudget& top = root();
  std::unique_lock lock(top.mutex_);
  top.released_.wait_for(lock, absl::ToChronoMilliseconds(timeout),
                         [&] { return top.num_releases_ > num_seen; });
}

void MemoryBudget::AddReclaimer(Reclaimer reclaim) {
  root().reclaimers_.push_back(std::move(reclaim));
}

uint64_t MemoryBudget::used_bytes() const {
  std::lock_guard lock(mutex_);
  return used_bytes_;
}

}  // namespace pleat
