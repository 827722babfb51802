// The whole program except for the process around it.
#pragma once

#include <string>
#include <vector>

#include "cli/exit_code.h"
#include "cli/session.h"

namespace pleat {

// Parses `arguments`, which do not include the program's name, and runs the chosen verb. Reports
// its error on session.err as "pleat VERB: message".
ExitCode RunCommandLine(const std::vector<std::string>& arguments, Session& session);

// Runs session.run, which may throw, and reports its error. The text of an exception is not shown.
ExitCode RunChosenVerb(Session& session);

}  // namespace pleat
