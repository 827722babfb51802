#include "cli/show/completion.h"

#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"

namespace pleat {
namespace {

std::vector<std::string> WordsOf(const Command& command) {
  std::vector<std::string> words;
  for (const Command& verb : command.verbs) words.push_back(verb.path.back());
  for (const CommandFlag& flag : command.flags) {
    words.insert(words.end(), flag.names.begin(), flag.names.end());
  }
  words.push_back("--help");
  return words;
}

// As one word of fish, in quotes.
std::string FishQuoted(const std::string& text) {
  return absl::StrCat("'", absl::StrReplaceAll(text, {{"\\", "\\\\"}, {"'", "\\'"}, {"\n", " "}}),
                      "'");
}

// Which verbs were chosen so far, as a condition of fish.
std::string FishCondition(const Command& command) {
  std::vector<std::string> conditions;
  for (const std::string& word : command.path) {
    conditions.push_back(absl::StrCat("__fish_seen_subcommand_from ", word));
  }
  if (!command.verbs.empty()) {
    std::vector<std::string> below;
    for (const Command& verb : command.verbs) below.push_back(verb.path.back());
    conditions.push_back(
        absl::StrCat("not __fish_seen_subcommand_from ", absl::StrJoin(below, " ")));
  }
  return absl::StrJoin(conditions, "; and ");
}

}  // namespace

std::string BashCompletion(const Command& program) {
  std::string paths, words;
  ForCommands(program, [&](const Command& command) {
    const std::string path = absl::StrJoin(command.path, " ");
    if (!command.path.empty()) {
      absl::StrAppend(&paths, paths.empty() ? "" : "|", "'", path, "'");
    }
    absl::StrAppend(&words, "    '", path, "') words='", absl::StrJoin(WordsOf(command), " "),
                    "' ;;\n");
  });
  return absl::StrCat(
      "# Completion of pleat for bash; made by 'pleat completion bash'.\n"
      "_pleat() {\n"
      "  local current=${COMP_WORDS[COMP_CWORD]} path='' word next words=''\n"
      "  for word in \"${COMP_WORDS[@]:1:COMP_CWORD-1}\"; do\n"
      "    next=${path:+$path }$word\n"
      "    case $next in\n"
      "      ",
      paths,
      ") path=$next ;;\n"
      "    esac\n"
      "  done\n"
      "  case $path in\n",
      words,
      "  esac\n"
      "  COMPREPLY=()\n"
      "  # File names where neither a verb nor a flag is meant.\n"
      "  if [[ $current == -* || -z $path ]]; then\n"
      "    COMPREPLY=($(compgen -W \"$words\" -- \"$current\"))\n"
      "  else\n"
      "    for word in $words; do\n"
      "      [[ $word != -* && $word == \"$current\"* ]] && COMPREPLY+=(\"$word\")\n"
      "    done\n"
      "  fi\n"
      "  return 0\n"
      "}\n"
      "complete -o default -F _pleat pleat\n");
}

std::string ZshCompletion(const Command& program) {
  return absl::StrCat(
      "#compdef pleat\n"
      "autoload -U +X bashcompinit && bashcompinit\n",
      BashCompletion(program));
}

std::string FishCompletion(const Command& program) {
  std::string script = "# Completion of pleat for fish; made by 'pleat completion fish'.\n";
  ForCommands(program, [&](const Command& command) {
    const std::string condition = FishCondition(command);
    const std::string begin = absl::StrCat("complete -c pleat", condition.empty() ? "" : " -n ",
                                           condition.empty() ? "" : FishQuoted(condition));
    for (const Command& verb : command.verbs) {
      absl::StrAppend(&script, begin, " -f -a ", verb.path.back(), " -d ",
                      FishQuoted(verb.description), "\n");
    }
    for (const CommandFlag& flag : command.flags) {
      if (flag.names.empty()) continue;
      absl::StrAppend(&script, begin);
      for (const std::string& name : flag.names) {
        const bool is_long = name.starts_with("--");
        absl::StrAppend(&script, is_long ? " -l " : " -s ", name.substr(is_long ? 2 : 1));
      }
      absl::StrAppend(&script, flag.value.empty() ? "" : " -r", " -d ",
                      FishQuoted(flag.description), "\n");
    }
  });
  return script;
}

}  // namespace pleat
