// Ctrl-C (SIGINT) and SIGTERM as a flag that long computations look at.
#pragma once

namespace pleat {

// From now on the first signal sets the flag, and a second one ends the process at once.
void InstallInterruptHandler();
bool Interrupted();

// For verbs that only look, such as `jobs watch`: from now on the signal ends the process at once
// with ExitCode::kCancelled.
void ExitOnInterrupt();

}  // namespace pleat
