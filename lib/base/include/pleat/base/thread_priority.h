// Work that may wait for all other work.
#pragma once

namespace pleat {

// From now on the calling thread, and every thread that it starts, runs only in the processor time
// that no other thread wants. Where the system refuses that, nothing changes.
void RunInIdleTime();

}  // namespace pleat
