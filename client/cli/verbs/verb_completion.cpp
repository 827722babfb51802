// completion SHELL: a script with which a shell completes verbs and flags.
#include <memory>
#include <string>

#include "cli/show/completion.h"
#include "cli/verbs/verbs.h"

namespace pleat {

void AddCompletionVerb(CLI::App& app, Session& session) {
  auto shell = std::make_shared<std::string>();
  CLI::App* verb =
      AddVerb(app, session, "completion", "print a script that completes pleat in a shell",
              [shell, &app, &session] {
                const Command program = ReadCommand(app);
                *session.out << (*shell == "bash"  ? BashCompletion(program)
                                 : *shell == "zsh" ? ZshCompletion(program)
                                                   : FishCompletion(program));
                return absl::OkStatus();
              });
  verb->add_option("SHELL", *shell, "bash, zsh or fish")
      ->required()
      ->check(CLI::IsMember({"bash", "zsh", "fish"}));
}

}  // namespace pleat
