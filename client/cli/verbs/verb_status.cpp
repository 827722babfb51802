// status: whether a server serves.
#include <memory>

#include "cli/service.h"
#include "cli/show/json_text.h"
#include "cli/verbs/verbs.h"
#include "pleat/base/status.h"
#include "pleat/remote/remote_character_service.h"

namespace pleat {
namespace {

absl::Status RunStatus(const Session& session) {
  PLEAT_ASSIGN_OR_RETURN(const std::unique_ptr<RemoteCharacterService> service,
                         OpenRemoteService(session, "status"));
  PLEAT_RETURN_IF_ERROR(service->CheckHealth());
  if (session.json) {
    *session.out << JsonText({{"server", session.ServerAddress()}, {"serving", true}});
  } else {
    *session.out << session.ServerAddress() << " serves\n";
  }
  return absl::OkStatus();
}

}  // namespace

void AddStatusVerb(CLI::App& app, Session& session) {
  AddServerFlags(AddVerb(app, session, "status",
                         "ask a server whether it serves; exit code 6 when it does not",
                         [&session] { return RunStatus(session); }),
                 session);
}

}  // namespace pleat
