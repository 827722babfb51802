// upload INPUT: puts a sequence into a store.
#include <memory>
#include <nlohmann/json.hpp>

#include "absl/strings/str_format.h"
#include "cli/io/input.h"
#include "cli/service.h"
#include "cli/show/info_json.h"
#include "cli/show/json_text.h"
#include "cli/show/progress_display.h"
#include "cli/show/text_table.h"
#include "cli/verbs/verbs.h"
#include "pleat/base/status.h"
#include "pleat/formats/sequence_file.h"

namespace pleat {
namespace {

struct UploadOptions {
  std::string input, fps;
  double ttl_hours = 0;
  bool forget = false;
};

absl::Status RunUpload(const UploadOptions& options, const Session& session) {
  PLEAT_ASSIGN_OR_RETURN(const MeshSequence sequence,
                         ReadInput(session, options.input, options.fps));
  PLEAT_ASSIGN_OR_RETURN(const std::unique_ptr<CharacterService> service, OpenService(session));
  if (options.forget) {
    return service->sequences().DeleteUpload(SequenceId(EncodeSequence(sequence)));
  }
  PLEAT_ASSIGN_OR_RETURN(
      const SequenceInfo info,
      UploadWithProgress(service->sequences(), sequence, session, TtlOf(options.ttl_hours)));
  if (session.json) {
    *session.out << JsonText(SequenceJson(info));
  } else {
    *session.out << info.id << "\n";
  }
  return absl::OkStatus();
}

}  // namespace

void AddUploadVerb(CLI::App& app, Session& session) {
  auto options = std::make_shared<UploadOptions>();
  CLI::App* verb = AddVerb(app, session, "upload", "store a sequence and print its id",
                           [options, &session] { return RunUpload(*options, session); });
  verb->add_option("INPUT", options->input, "any animation that pleat reads")->required();
  verb->add_option("--fps", options->fps, "frames per second, where the input does not say");
  AddObjectFlag(verb, session);
  AddTtlFlag(verb, "the sequence", &options->ttl_hours);
  verb->add_flag("--forget", options->forget,
                 "do not upload: remove what has arrived of an upload that broke off");
  AddServerFlags(verb, session);
}

}  // namespace pleat
