// The manual page of the command line.
#pragma once

#include <string>

#include "cli/show/command_tree.h"

namespace pleat {

// pleat(1) in the man macros of roff. It is the same for the same program, whatever the day.
std::string ManualPage(const Command& program, const std::string& version);

}  // namespace pleat
