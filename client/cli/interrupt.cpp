#include "cli/interrupt.h"

#include <signal.h>
#include <unistd.h>

#include <csignal>

#include "cli/exit_code.h"

namespace pleat {
namespace {

volatile std::sig_atomic_t interrupted = 0;

void Remember(int) { interrupted = 1; }
void Leave(int) { _exit(static_cast<int>(ExitCode::kCancelled)); }

void Install(void (*handler)(int), int flags) {
  struct sigaction action = {};
  action.sa_handler = handler;
  action.sa_flags = flags;
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

}  // namespace

// SA_RESETHAND restores the default after the first signal, so the second one ends the process.
void InstallInterruptHandler() { Install(Remember, SA_RESETHAND | SA_RESTART); }
void ExitOnInterrupt() { Install(Leave, 0); }
bool Interrupted() { return interrupted != 0; }

}  // namespace pleat
