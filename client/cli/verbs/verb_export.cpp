// export MODEL [--motion M] -o OUT: a character as other programs show it, without Pleat.
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "cli/exit_code.h"
#include "cli/io/frame_rate.h"
#include "cli/io/model_input.h"
#include "cli/io/output_path.h"
#include "cli/show/json_text.h"
#include "cli/show/progress_display.h"
#include "cli/show/text_table.h"
#include "cli/verbs/verbs.h"
#include "pleat/base/status.h"
#include "pleat/base/utf8.h"
#include "pleat/character/morph_basis.h"
#include "pleat/character/pose_evaluator.h"
#include "pleat/formats/bvh.h"
#include "pleat/formats/character_file.h"
#include "pleat/skinning/cut_influences.h"

namespace pleat {
namespace {

struct ExportOptions {
  std::string model, motion, output, fps, influences;
  int num_targets = 0;
  double max_error_mm = 0;
  bool points = false;
};

enum class ExportFormat { kGlb, kUsda, kBvh };

// What was written, for people and programs.
struct ExportResult {
  CharacterFile file;
  int most_influences = 0;
  InfluenceCutError cut;
};

absl::StatusOr<ExportFormat> ChooseExportFormat(const ExportOptions& options) {
  const std::string ending = std::filesystem::path(options.output).extension().string();
  const bool wants_targets = options.num_targets > 0 || options.max_error_mm > 0;
  std::optional<ExportFormat> format;
  if (ending == ".glb") format = ExportFormat::kGlb;
  if (ending == ".usda") format = ExportFormat::kUsda;
  if (ending == ".bvh") format = ExportFormat::kBvh;
  if (!format) {
    return UsageError(absl::StrCat("-o '", options.output, "': the ending '", ending,
                                   "' is unknown here; known: .glb, .usda, .bvh"));
  }
  if (wants_targets && *format != ExportFormat::kGlb) {
    return UsageError("--targets and --max-error-mm make morph targets, which .glb alone has");
  }
  if (options.points && *format != ExportFormat::kUsda) {
    return UsageError("--points writes the whole mesh of every frame, which .usda alone has");
  }
  if (options.motion.empty() && (wants_targets || options.points)) {
    return UsageError("--targets, --max-error-mm and --points show a clip: say which by --motion");
  }
  if (options.num_targets > 0 && options.max_error_mm > 0) {
    return UsageError("choose --targets or --max-error-mm");
  }
  return *format;
}

// Every engine reads four influences of a GLB; those that take no more would show others wrongly.
absl::StatusOr<int> ParseInfluences(const std::string& text, ExportFormat format) {
  if (text.empty() && format == ExportFormat::kGlb) return kStandardInfluences;
  if (text.empty() || text == "all") return kMaxInfluences;
  int number = 0;
  if (absl::SimpleAtoi(text, &number) && number >= 1 && number <= kMaxInfluences) return number;
  return UsageError(absl::StrCat("--influences '", text, "': choose all or 1 to ", kMaxInfluences));
}

// The character and its motion; what the motion says of the detail is in `strengths`.
absl::StatusOr<CharacterFile> LoadCharacter(const ExportOptions& options,
                                            const CharacterModel& model, int influences,
                                            const Session& session, DetailStrengths* strengths) {
  if (options.motion.empty()) return MakeCharacterFile(model, {}, influences);
  PLEAT_ASSIGN_OR_RETURN(Motion motion, LoadMotion(options.motion, options.fps, model, session));
  for (const std::string& warning : motion.warnings) {
    *session.err << "warning: " << EscapeControls(warning) << "\n";
  }
  *strengths = {std::move(motion.detail_strengths), std::move(motion.vertex_strengths)};
  if (!strengths->empty() && (options.num_targets > 0 || options.max_error_mm > 0)) {
    return absl::InvalidArgumentError(
        absl::StrCat(options.motion,
                     ": its strengths of the detail are not in morph targets; write the meshes "
                     "with --points or 'pleat pose', or undo the edits"));
  }
  if (motion.track.clip_starts().size() > 1) {
    *session.err << "note: the " << motion.track.clip_starts().size()
                 << " clips of the motion become one, since these files know no clips\n";
  }
  return WithContext(options.motion, MakeCharacterFile(model, motion, influences));
}

absl::Status AddFolds(const ExportOptions& options,
                      const std::shared_ptr<const CharacterModel>& model,
                      const DetailStrengths& strengths, const Progress& progress,
                      CharacterFile* file) {
  if (options.num_targets > 0 || options.max_error_mm > 0) {
    PLEAT_ASSIGN_OR_RETURN(file->morphs,
                           ComputeMorphBasis(model, file->rig.weights, file->track,
                                             {.num_targets = options.num_targets,
                                              .max_error_m = options.max_error_mm / 1000},
                                             progress.Stage("folds", 0, 1)));
  }
  if (!options.points) return absl::OkStatus();
  const Progress stage = progress.Stage("pose", 0, 1);
  PoseEvaluator evaluator(model);
  PLEAT_RETURN_IF_ERROR(evaluator.SetDetailStrengths(strengths));
  return evaluator.EvaluateClip(file->track, {}, [&](int t, const EvaluatedFrame& frame) {
    file->points.push_back(frame.positions);
    return stage.Report((t + 1.) / file->track.num_frames());
  });
}

absl::Status WriteExport(ExportFormat format, const std::string& path, const CharacterFile& file) {
  switch (format) {
    case ExportFormat::kGlb:
      return WriteCharacterGlb(path, file);
    case ExportFormat::kUsda:
      return WriteCharacterUsda(path, file);
    default:
      return WriteBvh(path, ClipFromPoses(file.rig.skeleton, file.track));
  }
}

nlohmann::ordered_json ExportJson(const ExportOptions& options, const ExportResult& result) {
  const CharacterFile& file = result.file;
  nlohmann::ordered_json json = {{"schema", "pleat.export/1"},
                                 {"output", options.output},
                                 {"num_frames", file.track.num_frames()},
                                 {"frame_rate", FormatFrameRate(file.frame_rate)},
                                 {"num_joints", file.rig.skeleton.num_joints()},
                                 {"num_vertices", file.topology.num_vertices()},
                                 {"influences",
                                  {{"kept", result.most_influences},
                                   {"cut_vertices", result.cut.num_vertices},
                                   {"rms_mm", 1000 * result.cut.rms_m},
                                   {"max_mm", 1000 * result.cut.max_m}}}};
  if (!file.morphs) return json;
  json["num_targets"] = file.morphs->targets.cols();
  for (const MorphBasisError& error : file.morphs->errors) {
    json["target_errors"].push_back({{"num_targets", error.num_targets},
                                     {"rms_mm", 1000 * error.rms_m},
                                     {"max_mm", 1000 * error.max_m}});
  }
  return json;
}

void PrintExport(const ExportOptions& options, const ExportResult& result, const Session& session) {
  if (session.json) {
    *session.out << JsonText(ExportJson(options, result));
    return;
  }
  const CharacterFile& file = result.file;
  if (file.morphs) {
    std::vector<std::vector<std::string>> rows;
    for (const MorphBasisError& error : file.morphs->errors) {
      rows.push_back({absl::StrCat(error.num_targets), absl::StrFormat("%.3f", 1000 * error.rms_m),
                      absl::StrFormat("%.2f", 1000 * error.max_m)});
    }
    *session.out << FormatTable({"targets", "rms mm", "max mm"}, rows);
  }
  *session.out << absl::StrFormat("%s: %d joints, %d vertices, %d frames", options.output,
                                  file.rig.skeleton.num_joints(), file.topology.num_vertices(),
                                  file.track.num_frames());
  if (file.morphs) *session.out << ", " << file.morphs->targets.cols() << " morph targets";
  if (result.cut.num_vertices > 0) {
    *session.out << absl::StrFormat(
        "; %d bones per vertex: %d vertices move by rms %.2f mm, at most %.2f mm",
        result.most_influences, result.cut.num_vertices, 1000 * result.cut.rms_m,
        1000 * result.cut.max_m);
  }
  *session.out << "\n";
}

absl::Status RunExport(const ExportOptions& options, const Session& session) {
  PLEAT_ASSIGN_OR_RETURN(const ExportFormat format, ChooseExportFormat(options));
  PLEAT_ASSIGN_OR_RETURN(const int influences, ParseInfluences(options.influences, format));
  PLEAT_RETURN_IF_ERROR(
      CheckOutputFiles(session, {{"-o", options.output, {".glb", ".usda", ".bvh"}}}));
  PLEAT_ASSIGN_OR_RETURN(const std::shared_ptr<const CharacterModel> model,
                         LoadModel(session, options.model));
  ExportResult result;
  DetailStrengths strengths;
  PLEAT_ASSIGN_OR_RETURN(result.file,
                         LoadCharacter(options, *model, influences, session, &strengths));
  result.most_influences = influences;
  result.cut = MeasureInfluenceCut(model->rig(), result.file.rig.weights, result.file.track);
  ProgressDisplay display(*session.err, ChooseProgressStyle(session), MonotonicSeconds);
  PLEAT_RETURN_IF_ERROR(
      AddFolds(options, model, strengths, InterruptibleProgress(&display), &result.file));
  PLEAT_RETURN_IF_ERROR(WriteExport(format, options.output, result.file));
  display.Finish();
  PrintExport(options, result, session);
  return absl::OkStatus();
}

}  // namespace

void AddExportVerb(CLI::App& app, Session& session) {
  auto options = std::make_shared<ExportOptions>();
  CLI::App* verb =
      AddVerb(app, session, "export", "write a character for other programs: skin, motion, folds",
              [options, &session] { return RunExport(*options, session); });
  verb->add_option("MODEL", options->model, "a .pleat file, or the id of a model on the server")
      ->required();
  verb->add_option("-o,--output", options->output, "OUT.glb, OUT.usda or OUT.bvh")->required();
  verb->add_option(
      "--motion", options->motion,
      "motion (.json, .bvh, .glb) or a mesh sequence of the character [the rest pose]");
  verb->add_option("--fps", options->fps, "frames per second of a motion that has none");
  verb->add_option(
      "--influences", options->influences,
      "bones per vertex: all or 1 to 8; what the cut costs is said [.glb: 4, others: all]");
  verb->add_option("--targets", options->num_targets,
                   "of .glb: so many morph targets that show the folds of the motion")
      ->check(CLI::Range(1, kMaxMorphTargets));
  verb->add_option("--max-error-mm", options->max_error_mm,
                   "of .glb: so many morph targets that no vertex is further off than this")
      ->check(CLI::PositiveNumber);
  verb->add_flag("--points", options->points,
                 "of .usda: also the whole mesh of every frame, folds included");
  AddForceFlag(verb, session);
  AddServerFlags(verb, session);
}

}  // namespace pleat
