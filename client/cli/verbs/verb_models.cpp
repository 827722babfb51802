// models: the trained characters of a service.
#include "absl/strings/str_format.h"
#include "cli/show/info_json.h"
#include "cli/show/time_text.h"
#include "cli/verbs/stored_verb.h"

namespace pleat {
namespace {

std::vector<std::string> ModelRow(const ModelInfo& model) {
  return {model.id.substr(0, 12),
          model.name,
          model.record.learner,
          absl::StrCat(model.num_vertices),
          absl::StrCat(model.record.num_frames),
          absl::StrFormat("%.3f", model.record.reconstruction.mean_percent),
          FormatBytes(static_cast<double>(model.size_bytes)),
          TimeText(model.life.created),
          KeptUntilText(model.life)};
}

}  // namespace

void AddModelsVerb(CLI::App& app, Session& session) {
  AddStoredVerb<ModelInfo>(
      app, session,
      {.verb = "models",
       .description = "list, show, delete or download characters",
       .kind = "model",
       .list = [](CharacterService& service) { return service.models().List(); },
       .remove = [](CharacterService& service,
                    const std::string& id) { return service.models().Delete(id); },
       .pin = [](CharacterService& service, const std::string& id,
                 bool pinned) { return service.models().SetPinned(id, pinned); },
       .download = [](CharacterService& service, const std::string& id,
                      const Progress& progress) { return service.models().Download(id, progress); },
       .file_ending = ".pleat",
       .json = ModelJson,
       .header = {"id", "name", "learner", "vertices", "frames", "error %", "size", "created (UTC)",
                  "kept until"},
       .row = ModelRow});
}

}  // namespace pleat
