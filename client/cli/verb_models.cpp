// models: trained characters of a service.
#include <memory>
#include <nlohmann/json.hpp>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "cli/exit_code.h"
#include "cli/info_json.h"
#include "cli/progress_display.h"
#include "cli/service.h"
#include "cli/text_table.h"
#include "cli/verbs.h"
#include "pleat/base/file.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

struct ModelsOptions {
  std::string action = "list", id, output;
};

void PrintTable(const std::vector<ModelInfo>& models, std::ostream& out) {
  std::vector<std::vector<std::string>> rows;
  for (const ModelInfo& model : models) {
    rows.push_back({model.id.substr(0, 12), model.name, model.record.learner,
                    absl::StrCat(model.num_vertices), absl::StrCat(model.record.num_frames),
                    absl::StrFormat("%.3f", model.record.reconstruction.mean_percent),
                    FormatBytes(static_cast<double>(model.size_bytes))});
  }
  out << FormatTable({"id", "name", "learner", "vertices", "frames", "error %", "size"}, rows);
}

absl::Status Download(CharacterService& service, const std::string& id, const std::string& output,
                      const Session& session) {
  if (output.empty()) return UsageError("'download' needs -o FILE");
  ProgressDisplay display(*session.err, ChooseProgressStyle(session), MonotonicSeconds);
  PLEAT_ASSIGN_OR_RETURN(
      const std::string bytes,
      service.DownloadModel(id, InterruptibleProgress(&display).Stage("download", 0, 1)));
  return WriteFile(output, bytes);
}

absl::Status RunModels(const ModelsOptions& options, const Session& session) {
  PLEAT_ASSIGN_OR_RETURN(const std::unique_ptr<CharacterService> service, OpenService(session));
  PLEAT_ASSIGN_OR_RETURN(const std::vector<ModelInfo> models, service->ListModels());
  if (options.action == "list") {
    nlohmann::ordered_json json = nlohmann::ordered_json::array();
    for (const ModelInfo& model : models) json.push_back(ModelJson(model));
    if (session.json)
      *session.out << json.dump(2) << "\n";
    else
      PrintTable(models, *session.out);
    return absl::OkStatus();
  }
  if (options.id.empty()) return UsageError(absl::StrCat("'", options.action, "' needs an id"));
  PLEAT_ASSIGN_OR_RETURN(const std::string id, FindModel(*service, options.id));
  if (options.action == "delete") return service->DeleteModel(id);
  if (options.action == "download") return Download(*service, id, options.output, session);
  PLEAT_ASSIGN_OR_RETURN(const ModelInfo model, service->GetModel(id));
  *session.out << ModelJson(model).dump(2) << "\n";
  return absl::OkStatus();
}

}  // namespace

void AddModelsVerb(CLI::App& app, Session& session) {
  auto options = std::make_shared<ModelsOptions>();
  CLI::App* verb = AddVerb(app, session, "models", "list, show, delete or download characters",
                           [options, &session] { return RunModels(*options, session); });
  verb->add_option("ACTION", options->action, "list, show, delete or download")
      ->check(CLI::IsMember({"list", "show", "delete", "download"}))
      ->capture_default_str();
  verb->add_option("ID", options->id, "id of a model, or its first digits");
  verb->add_option("-o,--output", options->output, "file to download to (.pleat)");
  AddServerFlags(verb, session);
}

}  // namespace pleat
