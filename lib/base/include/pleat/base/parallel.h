// Deterministic data parallelism: independent items, no reduction across threads.
#pragma once

#include <algorithm>
#include <functional>

#include "absl/status/status.h"
#include "pleat/base/progress.h"

namespace pleat {

// Calls body(item) for every item in [0, num_items), on up to `num_threads` threads (0 = one per
// core). Items must not depend on each other: the result is then the same for every thread count.
// An exception thrown by a body is rethrown here after all threads have ended.
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
