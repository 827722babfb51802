// motion edit FILE --EDIT ...: adds edits to a motion file, which keeps what it was made from.
// motion undo FILE: takes the last ones away again.
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "cli/exit_code.h"
#include "cli/io/edit_flags.h"
#include "cli/io/model_input.h"
#include "cli/io/output_path.h"
#include "cli/show/json_text.h"
#include "cli/verbs/motion_verbs.h"
#include "cli/verbs/verbs.h"
#include "pleat/base/file.h"
#include "pleat/base/status.h"
#include "pleat/base/utf8.h"
#include "pleat/formats/edited_motion_file.h"
#include "pleat/motion/apply_edits.h"

namespace pleat {
namespace {

struct EditVerbOptions {
  std::string file, output, model;
  // What the flags say, in their order.
  std::vector<std::pair<EditKind, std::string>> flags;
  int count = 1;  // of undo
};

absl::Status WriteEdited(const EditVerbOptions& options, const std::string& text,
                         const Session& session) {
  const std::string path = options.output.empty() ? options.file : options.output;
  if (text.size() > MeshLimits().max_document_bytes) {
    return absl::ResourceExhaustedError(
        absl::StrCat("the edited motion has ", text.size(), " bytes, more than ",
                     MeshLimits().max_document_bytes, ": such a file could not be read"));
  }
  PLEAT_RETURN_IF_ERROR(WriteFile(path, text));
  PLEAT_ASSIGN_OR_RETURN(const EditHistory history, DecodeEditHistory(text));
  nlohmann::ordered_json edits = nlohmann::ordered_json::array();
  for (const MotionEdit& edit : history.edits) edits.push_back(ToValidUtf8(DescribeEdit(edit)));
  if (session.json) {
    *session.out << JsonText(
        {{"schema", "pleat.motion_edits/1"}, {"output", path}, {"edits", std::move(edits)}});
    return absl::OkStatus();
  }
  *session.out << path << ": " << edits.size() << (edits.size() == 1 ? " edit\n" : " edits\n");
  for (size_t i = 0; i < edits.size(); ++i) {
    *session.out << "  " << i + 1 << ". " << EscapeControls(edits[i].get<std::string>()) << "\n";
  }
  return absl::OkStatus();
}

// The skeleton that the file holds, or that of --model.
absl::StatusOr<Skeleton> SkeletonFor(const EditVerbOptions& options, const std::string& text,
                                     const Session& session) {
  PLEAT_ASSIGN_OR_RETURN(std::optional<Skeleton> skeleton,
                         WithContext(options.file, DecodeMotionSkeleton(text)));
  if (skeleton) return *std::move(skeleton);
  if (options.model.empty()) {
    return UsageError(absl::StrCat("'", options.file,
                                   "' does not hold the skeleton of its character: give the "
                                   "character by --model"));
  }
  PLEAT_ASSIGN_OR_RETURN(const std::shared_ptr<const CharacterModel> model,
                         LoadModel(session, options.model));
  return model->skeleton();
}

absl::Status CheckOutput(const EditVerbOptions& options, const Session& session) {
  if (options.output.empty()) return absl::OkStatus();
  return CheckOutputFiles(session, {{"-o", options.output, {".json"}}});
}

absl::Status RunEdit(const EditVerbOptions& options, const Session& session) {
  PLEAT_RETURN_IF_ERROR(CheckOutput(options, session));
  PLEAT_ASSIGN_OR_RETURN(std::string text, ReadFile(options.file, MeshLimits().max_document_bytes));
  if (options.flags.empty()) return UsageError("give an edit: 'pleat motion edit --help' has them");
  PLEAT_ASSIGN_OR_RETURN(const Skeleton skeleton, SkeletonFor(options, text, session));
  for (const auto& [kind, value] : options.flags) {
    PLEAT_ASSIGN_OR_RETURN(MotionEdit edit, ParseEditFlag(kind, value));
    PLEAT_ASSIGN_OR_RETURN(text,
                           WithContext(options.file, AddEdit(skeleton, text, std::move(edit))));
  }
  return WriteEdited(options, text, session);
}

absl::Status RunUndo(const EditVerbOptions& options, const Session& session) {
  PLEAT_RETURN_IF_ERROR(CheckOutput(options, session));
  PLEAT_ASSIGN_OR_RETURN(const std::string text,
                         ReadFile(options.file, MeshLimits().max_document_bytes));
  PLEAT_ASSIGN_OR_RETURN(const std::string before,
                         WithContext(options.file, UndoEdits(text, options.count)));
  return WriteEdited(options, before, session);
}

}  // namespace

void AddMotionEditVerb(CLI::App& motion, Session& session) {
  auto options = std::make_shared<EditVerbOptions>();
  CLI::App* verb =
      AddVerbOfMotion(motion, session, "edit", "add edits to a motion file, which keeps its source",
                      [options, &session] { return RunEdit(*options, session); });
  verb->add_option("FILE", options->file, "motion file (.json)")->required();
  verb->add_option("-o,--output", options->output, "motion file (.json) [FILE itself]");
  verb->add_option("--model", options->model,
                   "the character, where FILE does not hold its skeleton");
  // Edits are applied in the order of their flags, so each takes its place when it is parsed.
  for (const EditForm& form : EditForms()) {
    const EditKind kind = form.kind;
    const std::string value = EditFlagValue(kind);
    const std::string help =
        value.empty() ? EditFlagHelp(kind) : absl::StrCat(value, ": ", EditFlagHelp(kind));
    if (value.empty()) {
      verb->add_flag_callback(
              EditFlag(kind), [options, kind] { options->flags.emplace_back(kind, ""); }, help)
          ->trigger_on_parse();
      continue;
    }
    verb->add_option_function<std::string>(
            EditFlag(kind),
            [options, kind](const std::string& text) { options->flags.emplace_back(kind, text); },
            help)
        ->trigger_on_parse();
  }
  AddForceFlag(verb, session);
  AddServerFlags(verb, session);
}

void AddMotionUndoVerb(CLI::App& motion, Session& session) {
  auto options = std::make_shared<EditVerbOptions>();
  CLI::App* verb =
      AddVerbOfMotion(motion, session, "undo", "take the last edits of a motion file away",
                      [options, &session] { return RunUndo(*options, session); });
  verb->add_option("FILE", options->file, "motion file (.json) with edits")->required();
  verb->add_option("-o,--output", options->output, "motion file (.json) [FILE itself]");
  verb->add_option("--count", options->count, "so many edits")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  AddForceFlag(verb, session);
}

}  // namespace pleat
