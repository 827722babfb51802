// The verbs for what a service stores: list, show, delete, pin, unpin, download.
#pragma once

#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "cli/exit_code.h"
#include "cli/io/output_path.h"
#include "cli/service.h"
#include "cli/show/json_text.h"
#include "cli/show/progress_display.h"
#include "cli/show/text_table.h"
#include "cli/verbs/verbs.h"
#include "pleat/base/file.h"
#include "pleat/base/status.h"

namespace pleat {

// One kind of stored things. Info must have an id.
template <typename Info>
struct StoredThings {
  std::string verb, description;
  std::string kind;  // what messages and --help call one of them, such as "model"
  absl::StatusOr<std::vector<Info>> (*list)(CharacterService& service);
  absl::Status (*remove)(CharacterService& service, const std::string& id);
  absl::Status (*pin)(CharacterService& service, const std::string& id, bool pinned);
  // Null when they cannot be downloaded.
  absl::StatusOr<std::string> (*download)(CharacterService& service, const std::string& id,
                                          const Progress& progress);
  std::string file_ending;  // of a download, with the dot
  nlohmann::ordered_json (*json)(const Info&);
  std::vector<std::string> header;
  std::vector<std::string> (*row)(const Info&);
};

struct StoredVerbOptions {
  std::string action = "list", id, output;
};

template <typename Info>
absl::Status RunStoredVerb(const StoredThings<Info>& things, const StoredVerbOptions& options,
                           const Session& session) {
  if (options.action != "list" && options.id.empty()) {
    return UsageError(absl::StrCat("'", options.action, "' needs an id"));
  }
  if (options.action == "download" && options.output.empty()) {
    return UsageError("'download' needs -o FILE");
  }
  PLEAT_RETURN_IF_ERROR(CheckOutputFiles(session, {{"-o", options.output, {things.file_ending}}}));
  PLEAT_ASSIGN_OR_RETURN(const std::unique_ptr<CharacterService> service, OpenService(session));
  PLEAT_ASSIGN_OR_RETURN(const std::vector<Info> infos, things.list(*service));
  if (options.action == "list") {
    nlohmann::ordered_json json = nlohmann::ordered_json::array();
    std::vector<std::vector<std::string>> rows;
    for (const Info& info : infos) {
      json.push_back(things.json(info));
      rows.push_back(things.row(info));
    }
    *session.out << (session.json ? JsonText(json) : FormatTable(things.header, rows));
    return absl::OkStatus();
  }
  PLEAT_ASSIGN_OR_RETURN(const std::string id, CompleteId(infos, options.id, things.kind));
  if (options.action == "delete") return things.remove(*service, id);
  if (options.action == "pin") return things.pin(*service, id, true);
  if (options.action == "unpin") return things.pin(*service, id, false);
  if (options.action == "download") {
    ProgressDisplay display(*session.err, ChooseProgressStyle(session), MonotonicSeconds);
    PLEAT_ASSIGN_OR_RETURN(
        const std::string bytes,
        things.download(*service, id, InterruptibleProgress(&display).Stage("download", 0, 1)));
    return WriteFile(options.output, bytes);
  }
  for (const Info& info : infos) {
    if (info.id == id) *session.out << JsonText(things.json(info));
  }
  return absl::OkStatus();
}

template <typename Info>
void AddStoredVerb(CLI::App& app, Session& session, StoredThings<Info> things) {
  auto options = std::make_shared<StoredVerbOptions>();
  const bool can_download = things.download != nullptr;
  CLI::App* verb =
      AddVerb(app, session, things.verb, things.description,
              [options, things, &session] { return RunStoredVerb(things, *options, session); });
  std::vector<std::string> actions = {"list", "show", "delete", "pin", "unpin"};
  if (can_download) actions.push_back("download");
  verb->add_option("ACTION", options->action,
                   absl::StrCat("list, show, delete, pin, unpin", can_download ? ", download" : "",
                                "; retention never removes what is pinned"))
      ->check(CLI::IsMember(actions))
      ->capture_default_str();
  verb->add_option("ID", options->id,
                   absl::StrCat("id of a ", things.kind, ", or its first digits"));
  if (can_download) {
    verb->add_option("-o,--output", options->output,
                     absl::StrCat("file to download to (", things.file_ending, ")"));
    AddForceFlag(verb, session);
  }
  AddServerFlags(verb, session);
}

}  // namespace pleat
