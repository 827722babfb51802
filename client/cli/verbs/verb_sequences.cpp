// sequences: the mesh sequences of a service.
#include "cli/io/frame_rate.h"
#include "cli/show/info_json.h"
#include "cli/show/time_text.h"
#include "cli/verbs/stored_verb.h"

namespace pleat {
namespace {

std::vector<std::string> SequenceRow(const SequenceInfo& info) {
  return {info.id.substr(0, 12),
          info.name,
          absl::StrCat(info.num_frames),
          absl::StrCat(info.num_vertices),
          absl::StrCat(info.num_faces),
          FormatFrameRate(info.frame_rate),
          FormatBytes(static_cast<double>(info.size_bytes)),
          TimeText(info.life.created),
          KeptUntilText(info.life)};
}

}  // namespace

void AddSequencesVerb(CLI::App& app, Session& session) {
  AddStoredVerb<SequenceInfo>(
      app, session,
      {.verb = "sequences",
       .description = "list, show or delete stored sequences",
       .kind = "sequence",
       .list = [](CharacterService& service) { return service.sequences().List(); },
       .remove = [](CharacterService& service,
                    const std::string& id) { return service.sequences().Delete(id); },
       .pin = [](CharacterService& service, const std::string& id,
                 bool pinned) { return service.sequences().SetPinned(id, pinned); },
       .download = nullptr,
       .file_ending = "",
       .json = SequenceJson,
       .header = {"id", "name", "frames", "vertices", "faces", "fps", "size", "created (UTC)",
                  "kept until"},
       .row = SequenceRow});
}

}  // namespace pleat
