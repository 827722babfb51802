// The memory of one server: a number for everything, and who has how much of it.
#pragma once

#include <cstdint>

#include "pleat/base/memory_budget.h"

namespace pleat {

struct MemoryLimits {
  uint64_t memory_bytes = UINT64_MAX;           // everything together
  uint64_t cache_bytes = uint64_t{1} << 30;     // models
  uint64_t decode_bytes = uint64_t{1} << 30;    // all decoders of compressed sequences together
  uint64_t encoder_bytes = uint64_t{64} << 20;  // frame encoders that nobody uses at the moment
};

// Everything that grows with what clients ask for is reserved here before it is allocated. What is
// not: the program and its threads, what allocators keep, and a file of a model while it is read.
// docs/reliability.md states how much that is. It must outlive all services of the process.
struct MemoryOwners {
  explicit MemoryOwners(const MemoryLimits& limits)
      : all(limits.memory_bytes, "--memory-bytes"),
        decoders(limits.decode_bytes, "--decode-bytes", &all),
        encoders(limits.memory_bytes, "--memory-bytes", &all),
        uploads(limits.memory_bytes, "--memory-bytes", &all),
        jobs(limits.memory_bytes, "--memory-bytes", &all) {}

  MemoryBudget all;  // models charge it through their cache, and the server through its own budgets
  MemoryBudget decoders;
  MemoryBudget encoders;  // with the sessions that use them
  MemoryBudget uploads;   // while they are checked
  MemoryBudget jobs;
};

}  // namespace pleat
