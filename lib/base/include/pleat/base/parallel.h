// Deterministic data parallelism: independent items, no reduction across threads.
#pragma once

#include <algorithm>
#include <functional>

#include "absl/status/status.h"
#include "pleat/base/progress.h"

namespace pleat {

// Calls body(item) for every item in [0, num_items), on up to `num_threads` threads (0 = one per
// core), the caller's among them. Items are handed out in order but end in any order. They must not
// depend on each other: the result is then the same for every thread count. After an exception no
// further items are started, and the first one is rethrown here when all threads have ended.
// Threads are made for each call, so items should be worth it.
void ParallelFor(int num_items, int num_threads, const std::function<void(int item)>& body);

// The same for many small items: body(item) in pieces of `piece_size` items, of which none begins
// once `progress` is cancelled. kCancelled.
template <typename Body>
absl::Status ParallelForPieces(int num_items, int piece_size, int num_threads,
                               const Progress& progress, const Body& body) {
  const int num_pieces = (num_items + piece_size - 1) / piece_size;
  ParallelFor(num_pieces, num_threads, [&](int piece) {
    if (progress.cancelled()) return;
    const int end = std::min(num_items, (piece + 1) * piece_size);
    for (int item = piece * piece_size; item < end; ++item) body(item);
  });
  return progress.Report(1);
}

}  // namespace pleat
