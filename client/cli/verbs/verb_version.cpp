#include "cli/verbs/verbs.h"

namespace pleat {

void AddVersionVerb(CLI::App& app, Session& session) {
  AddVerb(app, session, "version", "print the version", [&session] {
    *session.out << (session.json ? "{\"version\":\"" PLEAT_VERSION "\"}" : "pleat " PLEAT_VERSION)
                 << "\n";
    return absl::OkStatus();
  });
}

}  // namespace pleat
