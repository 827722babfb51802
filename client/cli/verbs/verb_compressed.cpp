// compressed: the compressed sequences of a service.
#include "absl/strings/str_format.h"
#include "cli/show/info_json.h"
#include "cli/show/time_text.h"
#include "cli/verbs/stored_verb.h"

namespace pleat {
namespace {

std::vector<std::string> CompressedSequenceRow(const CompressedSequenceInfo& info) {
  return {info.id.substr(0, 12),
          info.name,
          absl::StrCat(info.num_frames),
          absl::StrCat(info.num_vertices),
          info.record ? absl::StrFormat("%.4g", info.record->summary.max_error_mm) : "",
          info.record ? absl::StrFormat("%.4g", info.record->summary.kg_percent) : "",
          FormatBytes(static_cast<double>(info.size_bytes)),
          TimeText(info.life.created),
          KeptUntilText(info.life)};
}

}  // namespace

void AddCompressedVerb(CLI::App& app, Session& session) {
  AddStoredVerb<CompressedSequenceInfo>(
      app, session,
      {.verb = "compressed",
       .description = "list, show, delete or download compressed sequences",
       .kind = "compressed sequence",
       .list = [](CharacterService& service) { return service.compressed_sequences().List(); },
       .remove = [](CharacterService& service,
                    const std::string& id) { return service.compressed_sequences().Delete(id); },
       .pin = [](CharacterService& service, const std::string& id,
                 bool pinned) { return service.compressed_sequences().SetPinned(id, pinned); },
       .download =
           [](CharacterService& service, const std::string& id, const Progress& progress) {
             return service.compressed_sequences().Download(id, progress);
           },
       .file_ending = ".plt",
       .json = CompressedSequenceJson,
       .header = {"id", "name", "frames", "vertices", "max mm", "KG %", "size", "created (UTC)",
                  "kept until"},
       .row = CompressedSequenceRow});
}

}  // namespace pleat
