// token create | list | revoke: who may call the server of a data folder.
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/time/time.h"
#include "cli/exit_code.h"
#include "cli/service.h"
#include "cli/show/json_text.h"
#include "cli/show/text_table.h"
#include "cli/verbs/verbs.h"
#include "pleat/base/status.h"
#include "pleat/base/wall_clock.h"
#include "pleat/identity/token_file.h"

namespace pleat {
namespace {

using nlohmann::ordered_json;

constexpr int kSecondsPerDay = 24 * 3600;

struct TokenVerbOptions {
  std::string action, folder, id, name, scopes, project = kDefaultProject;
  int days = 0;
};

int64_t UnixSeconds() { return absl::ToUnixSeconds(SystemTime()); }

std::string TimeText(std::optional<int64_t> seconds) {
  if (!seconds) return "";
  return absl::FormatTime("%Y-%m-%dT%H:%M:%SZ", absl::FromUnixSeconds(*seconds),
                          absl::UTCTimeZone());
}

const char* StateName(const Token& token, int64_t now) {
  if (token.revoked) return "revoked";
  return IsGood(token, now) ? "good" : "expired";
}

// The first token may be made before the server is started for the first time.
absl::Status MakeFolder(const std::string& folder) {
  std::error_code error;
  if (std::filesystem::create_directories(folder, error)) {
    std::filesystem::permissions(folder, std::filesystem::perms::owner_all, error);
  }
  if (!error) return absl::OkStatus();
  return ErrnoStatus(error.value(), absl::StrCat("cannot make '", folder, "'"));
}

absl::Status Create(const TokenVerbOptions& options, const Session& session) {
  if (options.name.empty() || options.scopes.empty()) {
    return UsageError("a new token needs --name and --scopes");
  }
  const int64_t now = UnixSeconds();
  std::optional<int64_t> expires;
  if (options.days > 0) expires = now + int64_t{options.days} * kSecondsPerDay;
  PLEAT_RETURN_IF_ERROR(CheckTokenName(options.name));
  PLEAT_ASSIGN_OR_RETURN(const ScopeSet scopes, ParseScopes(options.scopes));
  PLEAT_RETURN_IF_ERROR(CheckProjectName(options.project));
  PLEAT_RETURN_IF_ERROR(MakeFolder(options.folder));
  const NewToken made = MakeToken(options.name, scopes, now, expires, options.project);
  PLEAT_RETURN_IF_ERROR(ChangeTokens(TokenPath(options.folder), [&](std::vector<Token>* tokens) {
    tokens->push_back(made.token);
    return absl::OkStatus();
  }));
  if (session.json) {
    *session.out << JsonText({{"id", made.token.id}, {"token", made.text}});
  } else {
    *session.out << made.text << "\n";
    *session.err << "keep it: it is shown only now, and the server stores no more than its hash\n";
  }
  return absl::OkStatus();
}

absl::Status List(const TokenVerbOptions& options, const Session& session) {
  PLEAT_ASSIGN_OR_RETURN(const std::vector<Token> tokens, ReadTokens(TokenPath(options.folder)));
  const int64_t now = UnixSeconds();
  if (session.json) {
    ordered_json list = ordered_json::array();
    for (const Token& token : tokens) {
      list.push_back({{"id", token.id},
                      {"name", token.name},
                      {"project", token.project},
                      {"scopes", ScopesText(token.scopes)},
                      {"state", StateName(token, now)},
                      {"created", TimeText(token.created)},
                      {"expires", TimeText(token.expires)}});
    }
    *session.out << JsonText(list);
    return absl::OkStatus();
  }
  std::vector<std::vector<std::string>> rows;
  for (const Token& token : tokens) {
    rows.push_back({token.id, token.name, token.project, ScopesText(token.scopes),
                    StateName(token, now), TimeText(token.created), TimeText(token.expires)});
  }
  *session.out << FormatTable({"id", "name", "project", "scopes", "state", "created", "expires"},
                              rows);
  return absl::OkStatus();
}

absl::Status Revoke(const TokenVerbOptions& options, const Session& session) {
  if (options.id.empty()) return UsageError("say which token: its ID, or the first digits of it");
  std::string revoked;
  PLEAT_RETURN_IF_ERROR(
      ChangeTokens(TokenPath(options.folder), [&](std::vector<Token>* tokens) -> absl::Status {
        PLEAT_ASSIGN_OR_RETURN(const std::string id, CompleteId(*tokens, options.id, "token"));
        for (Token& token : *tokens) {
          if (token.id != id) continue;
          if (!token.revoked) token.revoked = UnixSeconds();
          revoked = token.id;
        }
        return absl::OkStatus();
      }));
  if (session.json) {
    *session.out << JsonText({{"revoked", revoked}});
  } else {
    *session.out << "revoked " << revoked << "\n";
  }
  return absl::OkStatus();
}

absl::Status RunToken(const TokenVerbOptions& options, const Session& session) {
  if (options.action == "create") return Create(options, session);
  if (options.action == "list") return List(options, session);
  return Revoke(options, session);
}

}  // namespace

void AddTokenVerb(CLI::App& app, Session& session) {
  auto options = std::make_shared<TokenVerbOptions>();
  CLI::App* verb = AddVerb(app, session, "token",
                           "make, list or revoke the tokens with which clients call a server",
                           [options, &session] { return RunToken(*options, session); });
  verb->add_option("ACTION", options->action, "create, list or revoke")
      ->check(CLI::IsMember({"create", "list", "revoke"}))
      ->required();
  verb->add_option("FOLDER", options->folder, "the data folder of the server")->required();
  verb->add_option("ID", options->id, "revoke: which token");
  verb->add_option("--name", options->name, "create: whose token it is");
  verb->add_option("--scopes", options->scopes,
                   "create: what it allows, some of read,pose,train,admin");
  verb->add_option("--project", options->project,
                   "create: what it sees; projects do not see each other")
      ->capture_default_str();
  verb->add_option("--days", options->days, "create: how long it is good [for ever]")
      ->check(CLI::Range(1, 36500));
}

}  // namespace pleat
