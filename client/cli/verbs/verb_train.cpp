// train INPUT... -o model.pleat: trains a character, here or on a server, with the same bytes.
#include <sys/resource.h>

#include <algorithm>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "cli/exit_code.h"
#include "cli/io/input.h"
#include "cli/io/output_path.h"
#include "cli/service.h"
#include "cli/show/error_text.h"
#include "cli/show/info_json.h"
#include "cli/show/input_notes_json.h"
#include "cli/show/json_text.h"
#include "cli/show/progress_display.h"
#include "cli/show/report_json.h"
#include "cli/show/text_table.h"
#include "cli/verbs/train_flags.h"
#include "cli/verbs/verbs.h"
#include "pleat/base/file.h"
#include "pleat/base/status.h"
#include "pleat/character/train_character.h"
#include "pleat/character/train_with_rig.h"
#include "pleat/formats/model_file.h"
#include "pleat/formats/rig_file.h"
#include "pleat/mesh/frame_jumps.h"

namespace pleat {
namespace {

struct TrainVerbOptions {
  std::vector<std::string> inputs;
  std::string output, report, fps, rig;
  std::string skin;                 // of `rig`, by name or number
  std::vector<std::string> locked;  // the joints of `rig` that are locked
  TrainFlags flags;
  TrainResources resources;
  bool detach = false;
  double ttl_hours = 0;
};

struct TrainedModel {
  std::shared_ptr<const CharacterModel> model;
  std::string bytes;
  std::string id;                         // on the service that trained it, if one did
  std::map<std::string, double> seconds;  // by the name of the stage
};

// Trains in this process. Without `rig`, which may be null, it finds one.
absl::StatusOr<TrainedModel> TrainHere(const std::vector<MeshSequence>& clips, const UserRig* rig,
                                       const TrainOptions& options, const TrainResources& resources,
                                       const Session& session) {
  TrainedModel trained;
  ProgressDisplay display(*session.err, ChooseProgressStyle(session), MonotonicSeconds);
  const Progress progress = InterruptibleProgress(&display);
  PLEAT_ASSIGN_OR_RETURN(
      trained.model, rig ? TrainCharacterWithRig(clips, *rig, options, resources, nullptr, progress)
                         : TrainCharacter(clips, options, resources, nullptr, progress));
  display.Finish();
  trained.seconds = display.stage_seconds();
  trained.bytes = EncodeModel(*trained.model);
  return trained;
}

// Returns the rig of --rig for the first clip, with the joints of --lock, or none without --rig.
absl::StatusOr<std::optional<UserRig>> ReadUserRig(const TrainVerbOptions& options,
                                                   const MeshSequence& clip, const Session& session,
                                                   std::vector<InputNote>* notes) {
  if (options.rig.empty()) return std::optional<UserRig>();
  PLEAT_ASSIGN_OR_RETURN(RigFile file, ReadRigFile(options.rig, {}, options.skin));
  PLEAT_RETURN_IF_ERROR(LockJoints(options.locked, &file));
  std::vector<InputNote> rig_notes;
  PLEAT_ASSIGN_OR_RETURN(UserRig rig, ResolveRig(file, clip, &rig_notes));
  SayNotes(session, rig_notes, notes);
  return std::optional<UserRig>(std::move(rig));
}

// Uploads the clips and creates a job for them. Without `rig`, which may be null, it finds a rig.
// ttl: how long the service keeps the clips and the model at least.
absl::StatusOr<JobInfo> CreateJob(CharacterService& service, const std::vector<MeshSequence>& clips,
                                  const UserRig* rig, const TrainOptions& options,
                                  absl::Duration ttl, const Session& session) {
  // A model without a name of its own is named after its first clip, as in TrainHere.
  TrainingRequest request{.options = options, .model_ttl = ttl};
  if (rig) request.rig = EncodeRig(*rig);
  for (const MeshSequence& clip : clips) {
    PLEAT_ASSIGN_OR_RETURN(const SequenceInfo info,
                           UploadWithProgress(service.sequences(), clip, session, ttl));
    request.sequence_ids.push_back(info.id);
  }
  return service.jobs().CreateTraining(request);
}

absl::StatusOr<TrainedModel> TrainOnService(CharacterService& service, const JobInfo& job,
                                            const Session& session) {
  TrainedModel trained;
  PLEAT_ASSIGN_OR_RETURN(const JobInfo done,
                         WatchJobToEnd(service.jobs(), job.id, session, true, &trained.seconds));
  trained.id = done.result_id;
  ProgressDisplay display(*session.err, ChooseProgressStyle(session), MonotonicSeconds);
  PLEAT_ASSIGN_OR_RETURN(
      trained.bytes, service.models().Download(
                         done.result_id, InterruptibleProgress(&display).Stage("download", 0, 1)));
  PLEAT_ASSIGN_OR_RETURN(trained.model, DecodeModel(trained.bytes));
  return trained;
}

// Returns the seconds of the steps that a report names. A learner's own stages count as "learn".
std::map<std::string, double> StepSeconds(const std::map<std::string, double>& stage_seconds) {
  static const std::set<std::string> steps = {"queued", "read",   "rig",     "fit",
                                              "refine", "detail", "measure", "store"};
  std::map<std::string, double> seconds = {{"rig", 0}, {"fit", 0}, {"learn", 0}};
  for (const auto& [stage, value] : stage_seconds) {
    seconds[steps.count(stage) > 0 ? stage : "learn"] += value;
  }
  return seconds;
}

uint64_t PeakMemoryBytes() {
  struct rusage usage = {};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<uint64_t>(usage.ru_maxrss) * 1024;  // Linux counts in KiB
}

// Prints where to look: the frames and bones that skinning fits worst, and what smoothing did.
void PrintWorst(const CharacterModel& model, std::ostream& out) {
  const TrainingRecord& record = model.record();
  const bool several = std::any_of(record.worst_frames.begin(), record.worst_frames.end(),
                                   [](const FrameError& error) { return error.clip > 0; });
  out << "worst frames, skinned only:";
  for (const FrameError& error : record.worst_frames) {
    out << (several ? absl::StrFormat(" %d:%d", error.clip, error.frame)
                    : absl::StrFormat(" %d", error.frame))
        << absl::StrFormat(" (%.2f %%)", error.mean_percent);
  }
  std::vector<int> joints(record.joint_fit_percent.size());
  std::iota(joints.begin(), joints.end(), 0);
  std::stable_sort(joints.begin(), joints.end(), [&](int a, int b) {
    return record.joint_fit_percent[a] > record.joint_fit_percent[b];
  });
  joints.resize(std::min<size_t>(3, joints.size()));
  out << "\nworst bones:";
  for (const int j : joints) {
    out << absl::StrFormat(" %s (%.2f %%)", model.skeleton().joint(j).name,
                           record.joint_fit_percent[j]);
  }
  out << "\n";
  if (model.options().smoothness > 0) {
    out << absl::StrFormat("smoothing: jitter %.2f -> %.2f degrees, fit RMS %.3f -> %.3f %%\n",
                           record.unsmoothed_jitter_degrees, record.pose_jitter_degrees,
                           record.unsmoothed_rms_percent, record.fit.rms_percent);
  }
}

void PrintText(const TrainedModel& trained, const std::string& output, std::ostream& out) {
  const TrainingRecord& record = trained.model->record();
  for (const std::string& warning : record.warnings) out << "warning: " << warning << "\n";
  out << absl::StrFormat("rig from frame %d, facing %.0f degrees, residual %.4f; learner %s\n",
                         record.rest_frame, record.yaw_degrees, record.rig_residual, record.learner)
      << FormatTable(ErrorTableHeader("training frames"),
                     {ErrorTableRow("skinned only", record.fit, record.diagonal_m),
                      ErrorTableRow("hybrid", record.reconstruction, record.diagonal_m)});
  out << ValidationText(record.validation);
  PrintWorst(*trained.model, out);
  if (!trained.id.empty()) out << "model " << trained.id << "\n";
  if (!output.empty()) {
    out << output << ", " << FormatBytes(static_cast<double>(trained.bytes.size())) << "\n";
  }
}

absl::Status PrintDetached(const JobInfo& job, const Session& session) {
  *session.out << (session.json ? JsonText(JobJson(job)) : job.id + "\n");
  return absl::OkStatus();
}

// A server that is not there is no reason to give up.
absl::Status WithLocalHint(const absl::Status& status, const Session& session) {
  if (session.local || !absl::IsUnavailable(status)) return status;
  return absl::UnavailableError(
      absl::StrCat(status.message(), "; --local trains in this process, without a server"));
}

absl::StatusOr<std::vector<MeshSequence>> ReadClips(const TrainVerbOptions& options,
                                                    const Session& session,
                                                    std::vector<InputNote>* notes) {
  std::vector<MeshSequence> clips;
  for (const std::string& input : options.inputs) {
    PLEAT_ASSIGN_OR_RETURN(MeshSequence clip, ReadInput(session, input, options.fps, notes));
    clips.push_back(std::move(clip));
  }
  return clips;
}

absl::Status CheckFlags(const TrainVerbOptions& options, const Session& session) {
  const bool here = session.local && session.data_dir.empty();
  if (options.output.empty() && here) return UsageError("--local without --data-dir needs -o FILE");
  if (!options.locked.empty() && options.rig.empty()) {
    return UsageError("--lock needs --rig: `pleat rig INPUT -o rig.json` writes the automatic one");
  }
  if (!options.skin.empty() && options.rig.empty()) {
    return UsageError("--skin chooses a skin of the GLB that --rig names");
  }
  if (options.flags.values.contains("placed_joints") && !options.rig.empty()) {
    return UsageError("--at places joints of the automatic rig; move those of --rig in its file");
  }
  if (options.detach && session.local) return UsageError("--detach needs a server");
  return CheckOutputFiles(
      session, {{"-o", options.output, {".pleat"}}, {"--report", options.report, {".json"}}});
}

absl::Status RunTrain(const TrainVerbOptions& options, const Session& session) {
  PLEAT_RETURN_IF_ERROR(CheckFlags(options, session));
  PLEAT_ASSIGN_OR_RETURN(const TrainOptions train, ResolveTrainFlags(options.flags));
  const double start_seconds = MonotonicSeconds();
  std::vector<InputNote> notes;
  PLEAT_ASSIGN_OR_RETURN(const std::vector<MeshSequence> clips,
                         ReadClips(options, session, &notes));
  const double read_seconds = MonotonicSeconds() - start_seconds;

  PLEAT_ASSIGN_OR_RETURN(const std::optional<UserRig> rig,
                         ReadUserRig(options, clips[0], session, &notes));
  const UserRig* user_rig = rig ? &*rig : nullptr;
  // Clips of one frame each may teach something together.
  if (clips.size() == 1) PLEAT_RETURN_IF_ERROR(CheckIsClip(clips[0], options.inputs[0]));

  TrainedModel trained;
  if (session.local && session.data_dir.empty()) {
    TrainResources resources = options.resources;
    resources.clips_are_known_without_jumps = std::ranges::none_of(notes, IsJumpNote);
    PLEAT_ASSIGN_OR_RETURN(trained, TrainHere(clips, user_rig, train, resources, session));
  } else {
    const absl::StatusOr<std::unique_ptr<CharacterService>> opened = OpenService(session);
    if (!opened.ok()) return WithLocalHint(opened.status(), session);
    CharacterService& service = **opened;
    PLEAT_ASSIGN_OR_RETURN(const JobInfo job, CreateJob(service, clips, user_rig, train,
                                                        TtlOf(options.ttl_hours), session));
    if (options.detach) return PrintDetached(job, session);
    PLEAT_ASSIGN_OR_RETURN(trained, TrainOnService(service, job, session));
  }
  trained.seconds = StepSeconds(trained.seconds);
  trained.seconds["read"] = read_seconds;
  trained.seconds["total"] = MonotonicSeconds() - start_seconds;

  if (!options.output.empty()) PLEAT_RETURN_IF_ERROR(WriteFile(options.output, trained.bytes));
  nlohmann::ordered_json report = TrainReportJson(
      *trained.model,
      {trained.seconds, PeakMemoryBytes(), trained.bytes.size(), ModelId(trained.bytes)});
  report["input_notes"] = InputNotesJson(notes);
  if (!options.report.empty()) {
    PLEAT_RETURN_IF_ERROR(WriteFile(options.report, JsonText(report)));
  }
  if (session.json) {
    *session.out << JsonText(report);
  } else {
    PrintText(trained, options.output, *session.out);
  }
  return RefuseWarningsWhenStrict(session, trained.model->record().warnings.size());
}

}  // namespace

void AddTrainVerb(CLI::App& app, Session& session) {
  auto options = std::make_shared<TrainVerbOptions>();
  CLI::App* verb = AddVerb(app, session, "train", "turn clips of one character into a model",
                           [options, &session] { return RunTrain(*options, session); });
  verb->add_option("INPUT", options->inputs, "clips of one connectivity")->required();
  verb->add_option("-o,--output", options->output, "model file (.pleat)");
  verb->add_option("--report", options->report, "JSON report (pleat.train/1)");
  verb->add_option("--fps", options->fps, "frames per second, where the inputs do not say");
  AddObjectFlag(verb, session);
  verb->add_option("--threads", options->resources.num_threads,
                   "with --local: threads, 0 = one per core; the result does not depend on it")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  verb->add_flag("--detach", options->detach, "print the job's id and do not wait for it");
  verb->add_option(
      "--rig", options->rig,
      "your own rig instead of the automatic one: .json or .glb (docs/formats/rig.md)");
  verb->add_option("--skin", options->skin,
                   "name or number (from 0) of the skin of --rig, where a GLB has several");
  verb->add_option("--lock", options->locked,
                   "joints of --rig that refinement leaves where they are: NAME,NAME,...")
      ->delimiter(',');
  AddTtlFlag(verb, "the clips and the model", &options->ttl_hours);
  AddTrainFlags(verb, &options->flags);
  AddForceFlag(verb, session);
  AddServerFlags(verb, session);
}

}  // namespace pleat
