// The whole program but for the process around it.
#pragma once

#include <string>
#include <vector>

#include "cli/exit_code.h"
#include "cli/session.h"

namespace pleat {

// Parses `arguments` (without the program's name), runs the chosen verb and reports its error on
// session.err as "pleat VERB: message".
ExitCode RunCommandLine(const std::vector<std::string>& arguments, Session& session);

}  // namespace pleat
