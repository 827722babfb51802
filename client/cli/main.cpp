// The command line `pleat` (client/README.md).
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <iostream>
#include <string>
#include <vector>

#include "cli/command_line.h"
#include "cli/interrupt.h"

namespace {

std::string Environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGPIPE, SIG_IGN);  // `pleat ... | head` ends with an error, not with a signal
  pleat::InstallInterruptHandler();
  pleat::Session session;
  session.out = &std::cout;
  session.err = &std::cerr;
  session.err_is_terminal = isatty(STDERR_FILENO) == 1;
  session.environment_server = Environment("PLEAT_SERVER");
  session.environment_data = Environment("PLEAT_DATA");
  session.environment_home = Environment("HOME");
  session.environment_token = Environment("PLEAT_TOKEN");
  return static_cast<int>(
      pleat::RunCommandLine(std::vector<std::string>(argv + 1, argv + argc), session));
}
