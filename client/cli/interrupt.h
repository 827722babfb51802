// Ctrl-C (SIGINT) and SIGTERM as a flag that long computations look at.
#pragma once

namespace pleat {

// The first signal sets the flag, a second one ends the process at once.
void InstallInterruptHandler();
bool Interrupted();

// For verbs that only look (`jobs watch`): the signal ends the process at once with
// ExitCode::kCancelled.
void ExitOnInterrupt();

}  // namespace pleat
