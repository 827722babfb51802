// Deterministic data parallelism: independent items, no reduction across threads.
#pragma once

#include <functional>

namespace pleat {

// Calls body(item) for every item in [0, num_items), on up to `num_threads` threads (0 = one per
// core), the caller's among them. Items are handed out in order but end in any order. They must not
// depend on each other: the result is then the same for every thread count. After an exception no
// further items are started, and the first one is rethrown here when all threads have ended.
// Threads are made for each call, so items should be worth it.
void ParallelFor(int num_items, int num_threads, const std::function<void(int item)>& body);

}  // namespace pleat
