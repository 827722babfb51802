// sequences: what a store holds.
#include <memory>
#include <nlohmann/json.hpp>

#include "absl/strings/str_cat.h"
#include "cli/exit_code.h"
#include "cli/frame_rate.h"
#include "cli/info_json.h"
#include "cli/service.h"
#include "cli/text_table.h"
#include "cli/verbs.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

struct SequencesOptions {
  std::string action = "list", id;
};

void PrintTable(const std::vector<SequenceInfo>& sequences, std::ostream& out) {
  std::vector<std::vector<std::string>> rows;
  for (const SequenceInfo& info : sequences) {
    rows.push_back({info.id.substr(0, 12), info.name, absl::StrCat(info.num_frames),
                    absl::StrCat(info.num_vertices), absl::StrCat(info.num_faces),
                    FormatFrameRate(info.frame_rate),
                    FormatBytes(static_cast<double>(info.size_bytes))});
  }
  out << FormatTable({"id", "name", "frames", "vertices", "faces", "fps", "size"}, rows);
}

absl::Status RunSequences(const SequencesOptions& options, const Session& session) {
  PLEAT_ASSIGN_OR_RETURN(const std::unique_ptr<CharacterService> service, OpenService(session));
  PLEAT_ASSIGN_OR_RETURN(const std::vector<SequenceInfo> sequences, service->ListSequences());
  if (options.action == "list") {
    nlohmann::ordered_json json = nlohmann::ordered_json::array();
    for (const SequenceInfo& info : sequences) json.push_back(SequenceJson(info));
    if (session.json)
      *session.out << json.dump(2) << "\n";
    else
      PrintTable(sequences, *session.out);
    return absl::OkStatus();
  }
  if (options.id.empty()) return UsageError(absl::StrCat("'", options.action, "' needs an id"));
  std::vector<std::string> ids;
  for (const SequenceInfo& info : sequences) ids.push_back(info.id);
  PLEAT_ASSIGN_OR_RETURN(const std::string id, CompleteId(ids, options.id, "sequence"));
  if (options.action == "delete") return service->DeleteSequence(id);
  PLEAT_ASSIGN_OR_RETURN(const SequenceInfo info, service->GetSequence(id));
  *session.out << SequenceJson(info).dump(2) << "\n";
  return absl::OkStatus();
}

}  // namespace

void AddSequencesVerb(CLI::App& app, Session& session) {
  auto options = std::make_shared<SequencesOptions>();
  CLI::App* verb = AddVerb(app, session, "sequences", "list, show or delete stored sequences",
                           [options, &session] { return RunSequences(*options, session); });
  verb->add_option("ACTION", options->action, "list, show or delete")
      ->check(CLI::IsMember({"list", "show", "delete"}))
      ->capture_default_str();
  verb->add_option("ID", options->id, "id of a sequence, or its first digits");
  AddServerFlags(verb, session);
}

}  // namespace pleat
