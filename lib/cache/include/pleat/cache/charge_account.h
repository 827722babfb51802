// The bytes that a cache may hold and holds.
#pragma once

#include <cstdint>
#include <string>

#include "absl/status/status.h"

namespace pleat {

// Not thread-safe: its owner locks.
class ChargeAccount {
 public:
  explicit ChargeAccount(uint64_t capacity_bytes) : capacity_bytes_(capacity_bytes) {}

  bool Fits(uint64_t bytes) const { return bytes <= capacity_bytes_ - used_bytes_; }
  // kResourceExhausted, naming `key` and the numbers, when it does not fit.
  absl::Status Charge(uint64_t bytes, const std::string& key);
  void Release(uint64_t bytes) { used_bytes_ -= bytes; }

  uint64_t used_bytes() const { return used_bytes_; }
  uint64_t capacity_bytes() const { return capacity_bytes_; }

 private:
  uint64_t capacity_bytes_;
  uint64_t used_bytes_ = 0;  // <= capacity_bytes_
};

}  // namespace pleat
