#include "cli/command_line.h"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <memory>
#include <new>
#include <stdexcept>

#include "CLI/CLI.hpp"
#include "absl/strings/str_cat.h"
#include "cli/verbs/verbs.h"
#include "pleat/base/status.h"
#include "pleat/base/utf8.h"

namespace pleat {
namespace {

std::unique_ptr<CLI::App> MakeParser(Session& session) {
  auto app = std::make_unique<CLI::App>(
      "Pleat: from a captured mesh sequence to an editable character.\n"
      "INPUT is a folder or quoted glob of .obj, .ply or .drc files, a .pc2, .mdd or .npy beside "
      "its .obj, an .npz, an .abc (Alembic), a .pseq, or one .glb or .gltf.",
      "pleat");
  app->require_subcommand(1);
  app->footer(std::string("\n") + ExitCodeHelp());
  AddInspectVerb(*app, session);
  AddRigVerb(*app, session);
  AddTrainVerb(*app, session);
  AddMotionVerb(*app, session);
  AddPoseVerb(*app, session);
  AddExportVerb(*app, session);
  AddEvaluateVerb(*app, session);
  AddRenderVerb(*app, session);
  AddCompareVerb(*app, session);
  AddConvertVerb(*app, session);
  AddCompressVerb(*app, session);
  AddDecompressVerb(*app, session);
  AddGenerateVerb(*app, session);
  AddStudioVerb(*app, session);
  AddBatchVerb(*app, session);
  AddUploadVerb(*app, session);
  AddSequencesVerb(*app, session);
  AddJobsVerb(*app, session);
  AddModelsVerb(*app, session);
  AddCompressedVerb(*app, session);
  AddBenchVerb(*app, session);
  AddStoreVerb(*app, session);
  AddTokenVerb(*app, session);
  AddStatusVerb(*app, session);
  AddCompletionVerb(*app, session);
  AddManualVerb(*app, session);
  AddVersionVerb(*app, session);
  return app;
}

// Returns "pleat" with the verb that the arguments name, for messages of the parser.
std::string Prefix(const std::vector<std::string>& arguments, const CLI::App& app) {
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (!arguments.empty() && verb->get_name() == arguments[0]) return "pleat " + arguments[0];
  }
  return "pleat";
}

// Pleat reports errors as statuses, but memory may run out anywhere, and other libraries throw.
// What an exception says is for developers, so none of it is shown.
absl::Status RunGuarded(const std::function<absl::Status()>& run) {
  try {
    return run();
  } catch (const std::bad_alloc&) {
    return absl::ResourceExhaustedError("out of memory: try fewer or smaller frames");
  } catch (const std::length_error&) {
    return absl::ResourceExhaustedError("a size is beyond all bounds: try fewer or smaller frames");
  } catch (const std::filesystem::filesystem_error& error) {
    return ErrnoStatus(error.code().value(),
                       absl::StrCat("cannot access '", error.path1().string(), "'"));
  } catch (const std::exception&) {
    return absl::InternalError("this is a fault of Pleat itself; please report the command");
  }
}

}  // namespace

ExitCode RunCommandLine(const std::vector<std::string>& arguments, Session& session) {
  const std::unique_ptr<CLI::App> app = MakeParser(session);
  try {
    // The parser takes the arguments from the back of the list.
    std::vector<std::string> reversed(arguments.rbegin(), arguments.rend());
    app->parse(reversed);
  } catch (const CLI::Success& help) {
    app->exit(help, *session.out, *session.err);
    return ExitCode::kOk;
  } catch (const CLI::ParseError& error) {
    const std::string prefix = Prefix(arguments, *app);
    *session.err << prefix << ": " << EscapeControls(error.what(), true) << "\nTry '" << prefix
                 << " --help'.\n";
    return ExitCode::kUsage;
  }

  return RunChosenVerb(session);
}

ExitCode RunChosenVerb(Session& session) {
  const absl::Status status = RunGuarded(session.run);
  if (!status.ok()) {
    // Messages quote files and their names, which may hold anything.
    *session.err << "pleat " << session.verb << ": "
                 << EscapeControls(std::string(status.message()), true) << "\n";
  }
  session.out->flush();
  return ExitCodeOf(status);
}

}  // namespace pleat
