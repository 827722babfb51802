// Deterministic data parallelism: independent items, no reduction across threads.
#pragma once

#include <functional>

namespace pleat {

// Calls body(item) for every item in [0, num_items), on up to `num_threads` threads (0 = one per
// core). Items must not depend on each other: the result is then the same for every thread count.
// An exception thrown by a body is rethrown here after all threads have ended.
void ParallelFor(int num_items, int num_threads, const std::function<void(int item)>& body);

}  // namespace pleat
