// status: whether a server serves, and whether it can store.
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "absl/strings/str_cat.h"
#include "cli/service.h"
#include "cli/show/json_text.h"
#include "cli/verbs/verbs.h"
#include "pleat/base/status.h"
#include "pleat/remote/remote_character_service.h"

namespace pleat {
namespace {

absl::Status RunStatus(const Session& session, bool must_store) {
  PLEAT_ASSIGN_OR_RETURN(const std::unique_ptr<RemoteCharacterService> service,
                         OpenRemoteService(session, "status"));
  PLEAT_ASSIGN_OR_RETURN(const ServerHealth health, service->CheckHealth());
  const std::string address = session.ServerAddress();
  if (session.json) {
    *session.out << JsonText(
        {{"server", address}, {"serves", health.serves}, {"can_store", health.can_store}});
  } else {
    *session.out << address << (health.serves ? " serves" : " does not serve")
                 << (health.can_store ? "" : " and cannot store anything") << "\n";
  }
  if (!health.serves) return absl::UnavailableError(absl::StrCat(address, " shuts down"));
  if (must_store && !health.can_store) {
    return absl::UnavailableError(
        absl::StrCat("the disk of ", address, " is full or in trouble; its log says more"));
  }
  return absl::OkStatus();
}

}  // namespace

void AddStatusVerb(CLI::App& app, Session& session) {
  auto must_store = std::make_shared<bool>(false);
  CLI::App* verb = AddVerb(app, session, "status",
                           "ask a server whether it serves; exit code 6 when it does not",
                           [must_store, &session] { return RunStatus(session, *must_store); });
  AddServerFlags(verb, session);
  verb->add_flag("--can-store", *must_store, "exit code 6 as well when it cannot store anything");
}

}  // namespace pleat
