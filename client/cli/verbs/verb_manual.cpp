// manual: pleat(1), for `man -l -` and for packages.
#include "cli/show/manual.h"
#include "cli/verbs/verbs.h"

namespace pleat {

void AddManualVerb(CLI::App& app, Session& session) {
  AddVerb(app, session, "manual", "print the manual page pleat(1)", [&app, &session] {
    *session.out << ManualPage(ReadCommand(app), PLEAT_VERSION);
    return absl::OkStatus();
  });
}

}  // namespace pleat
