#include "cli/show/manual.h"

#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "cli/exit_code.h"

namespace pleat {
namespace {

// Text as roff shows it: no line of it is a request.
std::string Escaped(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '\\') {
      escaped += "\\e";
    } else if (c == '-') {
      escaped += "\\-";
    } else {
      escaped.push_back(c);
    }
  }
  std::vector<std::string> lines = absl::StrSplit(escaped, '\n');
  for (std::string& line : lines) {
    if (!line.empty() && (line.front() == '.' || line.front() == '\'')) line.insert(0, "\\&");
  }
  return absl::StrJoin(lines, "\n");
}

std::string Bold(const std::string& text) { return absl::StrCat("\\fB", Escaped(text), "\\fR"); }
std::string Italic(const std::string& text) { return absl::StrCat("\\fI", Escaped(text), "\\fR"); }

std::string HeadOf(const CommandFlag& flag) {
  if (flag.names.empty()) return Italic(flag.positional);
  std::vector<std::string> names;
  for (const std::string& name : flag.names) names.push_back(Bold(name));
  return absl::StrCat(absl::StrJoin(names, ", "), flag.value.empty() ? "" : " ",
                      flag.value.empty() ? "" : Italic(flag.value));
}

void AppendCommand(const Command& command, std::string* page) {
  std::string synopsis = absl::StrJoin(command.path, " ");
  for (const CommandFlag& flag : command.flags) {
    if (!flag.names.empty()) continue;
    absl::StrAppend(&synopsis, flag.required ? " " : " [", flag.positional,
                    flag.required ? "" : "]");
  }
  absl::StrAppend(page, ".SS ", Escaped(synopsis), "\n", Escaped(command.description), "\n");
  for (const CommandFlag& flag : command.flags) {
    absl::StrAppend(page, ".TP\n", HeadOf(flag), "\n", Escaped(flag.description), "\n");
  }
}

// The lines of a help text, each on a line of its own.
std::string Listing(const std::string& text) {
  return absl::StrCat(".nf\n", Escaped(std::string(absl::StripAsciiWhitespace(text))), "\n.fi\n");
}

}  // namespace

std::string ManualPage(const Command& program, const std::string& version) {
  std::string page =
      absl::StrCat(".TH PLEAT 1 \"\" \"Pleat ", Escaped(version), "\" \"User Commands\"\n",
                   ".SH NAME\npleat \\- from a captured mesh sequence to an editable character\n",
                   ".SH SYNOPSIS\n.B pleat\n.I VERB\n[flags]\n", ".SH DESCRIPTION\n",
                   Escaped(program.description), "\n.SH VERBS\n");
  ForCommands(program, [&](const Command& command) {
    if (!command.path.empty()) AppendCommand(command, &page);
  });
  absl::StrAppend(
      &page, ".SH EXIT STATUS\n", Listing(ExitCodeHelp()), ".SH ENVIRONMENT\n",
      ".TP\n.B PLEAT_SERVER\nthe address of pleatd, where \\fB\\-\\-server\\fR is not given\n",
      ".TP\n.B PLEAT_DATA\nthe data folder, where \\fB\\-\\-data\\-dir\\fR is not given\n",
      ".TP\n.B PLEAT_TOKEN\nthe token for the server, where \\fB\\-\\-token\\-file\\fR is not "
      "given\n");
  return page;
}

}  // namespace pleat
