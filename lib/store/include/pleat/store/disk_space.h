// The room on the store's disk, and what is promised of it.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "absl/status/statusor.h"

namespace pleat {

class DiskSpace;

// Room that is kept for bytes that are still to be written. It is given back when the reservation
// is destroyed. Not thread-safe.
class SpaceReservation {
 public:
  SpaceReservation() = default;  // keeps nothing
  SpaceReservation(std::shared_ptr<DiskSpace> space, uint64_t bytes)
      : space_(std::move(space)), bytes_(bytes) {}
  ~SpaceReservation() { Spend(bytes_); }
  SpaceReservation(SpaceReservation&& other) noexcept
      : space_(std::move(other.space_)), bytes_(std::exchange(other.bytes_, 0)) {}
  SpaceReservation& operator=(SpaceReservation&& other) noexcept;

  // Notes that `bytes` have been written: from now on the disk itself counts them.
  void Spend(uint64_t bytes);
  uint64_t bytes() const { return bytes_; }

 private:
  std::shared_ptr<DiskSpace> space_;
  uint64_t bytes_ = 0;
};

// Writers ask for the room of everything that they are going to write, before the first byte. So
// writers that begin together cannot all be told yes for the same free bytes. Thread-safe.
class DiskSpace : public std::enable_shared_from_this<DiskSpace> {
 public:
  // Returns the free bytes of the disk.
  using AskFreeBytes = std::function<absl::StatusOr<uint64_t>()>;

  // reserve_bytes: what always stays free, so that deleting still works when the store is full.
  static std::shared_ptr<DiskSpace> Of(const std::string& folder, uint64_t reserve_bytes);
  DiskSpace(AskFreeBytes ask, uint64_t reserve_bytes)
      : ask_(std::move(ask)), reserve_bytes_(reserve_bytes) {}

  // kResourceExhausted when the disk would have less than the reserve once everything that is
  // promised has been written.
  absl::StatusOr<SpaceReservation> Reserve(uint64_t bytes);
  absl::StatusOr<uint64_t> FreeBytes() const { return ask_(); }

 private:
  friend class SpaceReservation;

  const AskFreeBytes ask_;
  const uint64_t reserve_bytes_;
  std::mutex mutex_;
  uint64_t promised_bytes_ = 0;  // guarded by mutex_
};

}  // namespace pleat
