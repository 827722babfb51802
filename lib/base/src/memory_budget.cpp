#include "pleat/base/memory_budget.h"

#include "absl/strings/str_cat.h"

namespace pleat {

Reservation::~Reservation() {
  if (budget_ == nullptr) return;
  std::lock_guard lock(budget_->mutex_);
  budget_->used_bytes_ -= bytes_;
}

void Reservation::ShrinkTo(uint64_t bytes) {
  if (budget_ == nullptr || bytes >= bytes_) return;
  std::lock_guard lock(budget_->mutex_);
  budget_->used_bytes_ -= bytes_ - bytes;
  bytes_ = bytes;
}

absl::StatusOr<Reservation> MemoryBudget::Reserve(uint64_t bytes, const std::string& what) {
  std::lock_guard lock(mutex_);
  if (bytes > capacity_bytes_ - used_bytes_) {
    return absl::ResourceExhaustedError(
        absl::StrCat(what, " needs ", bytes, " bytes of memory, but ", used_bytes_, " of ",
                     capacity_bytes_, " (", flag_, ") are in use; try again later"));
  }
  used_bytes_ += bytes;
  return Reservation(this, bytes);
}

uint64_t MemoryBudget::used_bytes() const {
  std::lock_guard lock(mutex_);
  return used_bytes_;
}

}  // namespace pleat
