// The bytes that a cache may hold and holds.
#pragma once

#include <cstdint>
#include <string>

#include "absl/status/statusor.h"
#include "pleat/base/memory_budget.h"

namespace pleat {

// Thread-safe.
class ChargeAccount {
 public:
  // memory: what the cache shares with others; may be null.
  explicit ChargeAccount(uint64_t capacity_bytes, MemoryBudget* memory = nullptr)
      : budget_(capacity_bytes, "--cache-bytes", memory) {}

  bool Fits(uint64_t bytes) const { return budget_.Fits(bytes); }
  // kResourceExhausted, naming `key` and the numbers, when it does not fit. It asks nobody for
  // memory: the cache itself is one of those who would be asked.
  absl::StatusOr<Reservation> Charge(uint64_t bytes, const std::string& key);

  uint64_t used_bytes() const { return budget_.used_bytes(); }
  uint64_t capacity_bytes() const { return budget_.capacity_bytes(); }

 private:
  MemoryBudget budget_;
};

}  // namespace pleat
