#include "cli/show/command_tree.h"

#include <utility>

namespace pleat {
namespace {

CommandFlag ReadFlag(const CLI::Option& option) {
  CommandFlag flag;
  for (const std::string& name : option.get_snames()) flag.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) flag.names.push_back("--" + name);
  if (option.get_positional()) flag.positional = option.get_name(true, false);
  if (option.get_items_expected_max() > 0) flag.value = option.get_type_name();
  flag.description = option.get_description();
  flag.required = option.get_required();
  return flag;
}

Command ReadBelow(const CLI::App& app, std::vector<std::string> path) {
  Command command;
  command.description = app.get_description();
  for (const CLI::Option* option : app.get_options()) {
    if (option != app.get_help_ptr()) command.flags.push_back(ReadFlag(*option));
  }
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; })) {
    std::vector<std::string> below = path;
    below.push_back(verb->get_name());
    command.verbs.push_back(ReadBelow(*verb, std::move(below)));
  }
  command.path = std::move(path);
  return command;
}

}  // namespace

Command ReadCommand(const CLI::App& app) { return ReadBelow(app, {}); }

}  // namespace pleat
