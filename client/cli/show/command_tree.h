// The verbs and flags of a parser as plain data, for manuals and completions.
#pragma once

#include <string>
#include <vector>

#include "CLI/CLI.hpp"

namespace pleat {

struct CommandFlag {
  std::vector<std::string> names{};  // with dashes, short ones first; empty: a positional
  std::string positional{};          // "INPUT"
  std::string value{};               // "TEXT", or empty for a flag without one
  std::string description{};
  bool required = false;
};

struct Command {
  std::vector<std::string> path;  // {"motion", "edit"}; empty: the program
  std::string description;
  std::vector<CommandFlag> flags;  // as the parser lists them, without --help
  std::vector<Command> verbs;      // below it
};

Command ReadCommand(const CLI::App& app);

// Calls `see` with the command and all below it, parents first.
template <typename See>
void ForCommands(const Command& command, const See& see) {
  see(command);
  for (const Command& verb : command.verbs) ForCommands(verb, see);
}

}  // namespace pleat
