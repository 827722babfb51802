#include "pleat/store/disk_space.h"

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "absl/strings/str_cat.h"
#include "pleat/base/limit_refusal.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

// Somebody has to delete something first.
constexpr absl::Duration kRetryAfter = absl::Minutes(5);

}  // namespace

SpaceReservation& SpaceReservation::operator=(SpaceReservation&& other) noexcept {
  if (this == &other) return *this;
  Spend(bytes_);
  space_ = std::move(other.space_);
  bytes_ = std::exchange(other.bytes_, 0);
  return *this;
}

void SpaceReservation::Spend(uint64_t bytes) {
  bytes = std::min(bytes, bytes_);
  if (bytes == 0) return;
  bytes_ -= bytes;
  std::lock_guard lock(space_->mutex_);
  space_->promised_bytes_ -= bytes;
}

std::shared_ptr<DiskSpace> DiskSpace::Of(const std::string& folder, uint64_t reserve_bytes) {
  const AskFreeBytes ask = [folder]() -> absl::StatusOr<uint64_t> {
    std::error_code error;
    const std::filesystem::space_info space = std::filesystem::space(folder, error);
    if (error) return ErrnoStatus(error.value(), "cannot ask for the free disk space");
    return space.available;
  };
  return std::make_shared<DiskSpace>(ask, reserve_bytes);
}

absl::StatusOr<SpaceReservation> DiskSpace::Reserve(uint64_t bytes) {
  PLEAT_ASSIGN_OR_RETURN(const uint64_t free_bytes, ask_());
  {
    std::lock_guard lock(mutex_);
    // Written as subtractions, since sums of numbers from outside may overflow.
    const uint64_t above = free_bytes - std::min(free_bytes, reserve_bytes_);
    if (free_bytes >= reserve_bytes_ && above >= promised_bytes_ &&
        above - promised_bytes_ >= bytes) {
      promised_bytes_ += bytes;
      return SpaceReservation(shared_from_this(), bytes);
    }
    return RefuseForLimit(
        {.limit = "--reserve-bytes", .retry_after = kRetryAfter},
        absl::StrCat("no room on the server's disk: ", free_bytes, " bytes free, of which ",
                     promised_bytes_, " are promised to other writers, and ", bytes,
                     " needed beside a reserve of ", reserve_bytes_,
                     "; delete sequences or models"));
  }
}

}  // namespace pleat
