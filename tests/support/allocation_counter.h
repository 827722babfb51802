// Counts heap allocations of the process, to prove that a query makes none.
#pragma once

namespace pleat {

// Allocations since the program began; -1 where they cannot be counted (sanitizers, other C
// libraries).
long NumAllocations();

}  // namespace pleat
