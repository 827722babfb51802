// Runs the command line in this process and keeps what it printed.
#pragma once

#include <sstream>
#include <string>
#include <vector>

#include "cli/command_line.h"

namespace pleat {

struct Outcome {
  ExitCode code;
  std::string out, err;
};

inline Outcome RunPleat(const std::vector<std::string>& arguments) {
  std::ostringstream out, err;
  Session session;
  session.out = &out;
  session.err = &err;
  const ExitCode code = RunCommandLine(arguments, session);
  return {code, out.str(), err.str()};
}

}  // namespace pleat
