// Completion of the command line by shells.
#pragma once

#include <string>

#include "cli/show/command_tree.h"

namespace pleat {

// Scripts that complete verbs and flags, and file names where neither fits.
std::string BashCompletion(const Command& program);
std::string ZshCompletion(const Command& program);  // bash's, by zsh's own bridge
std::string FishCompletion(const Command& program);

}  // namespace pleat
