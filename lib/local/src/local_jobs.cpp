// Jobs: what they are made of and what they do.
#include <algorithm>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "infos.h"
#include "pleat/base/sha256.h"
#include "pleat/base/status.h"
#include "pleat/character/train_with_rig.h"
#include "pleat/formats/model_file.h"
#include "pleat/local/compression.h"
#include "pleat/local/local_character_service.h"
#include "pleat/store/records.h"

namespace pleat {
namespace {

constexpr double kWatchWakeSeconds = .25;  // how soon a watcher notices a shutdown

// What can be said about a rig before its mesh is read.
absl::Status CheckRigCounts(const RigFile& rig, const SequenceInfo& clip) {
  if (rig.rest_frame >= clip.num_frames) {
    return absl::InvalidArgumentError(absl::StrCat("rig: rest_frame ", rig.rest_frame, " of '",
                                                   clip.name, "', which has ", clip.num_frames,
                                                   " frames"));
  }
  if (!rig.influences.empty() && rig.influences.size() != static_cast<size_t>(clip.num_vertices)) {
    return absl::InvalidArgumentError(absl::StrCat("rig: weights of ", rig.influences.size(),
                                                   " vertices; '", clip.name, "' has ",
                                                   clip.num_vertices));
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status LocalCharacterService::RestoreJobs() {
  PLEAT_ASSIGN_OR_RETURN(const std::vector<CatalogueEntry> entries,
                         store_->catalogue().List(EntryKind::kJob));
  std::vector<StoredJob> jobs;
  std::set<std::string> needed_rigs;
  for (const CatalogueEntry& entry : entries) {
    PLEAT_ASSIGN_OR_RETURN(JobInfo info, DecodeJobRecord(entry.record));
    if (!IsFinal(info.state)) needed_rigs.insert(info.rig_id);
    jobs.push_back({std::move(info), entry.attempts});
  }
  PLEAT_ASSIGN_OR_RETURN(const std::vector<CatalogueEntry> rigs,
                         store_->catalogue().List(EntryKind::kRig));
  for (const CatalogueEntry& rig : rigs) {
    if (needed_rigs.contains(rig.id)) continue;
    PLEAT_RETURN_IF_ERROR(store_->Delete(EntryKind::kRig, rig.id));
  }
  jobs_->Restore(std::move(jobs));
  return absl::OkStatus();
}

absl::StatusOr<JobInfo> LocalCharacterService::CreateTrainingJob(const TrainingRequest& request) {
  PLEAT_RETURN_IF_ERROR(ValidateTrainOptions(request.options));
  const size_t num_clips = request.sequence_ids.size();
  if (num_clips == 0 || num_clips > static_cast<size_t>(options_.limits.max_clips)) {
    return absl::InvalidArgumentError(absl::StrCat(
        "a training job needs 1 to ", options_.limits.max_clips, " sequences, not ", num_clips));
  }
  JobInfo draft;
  std::vector<SequenceInfo> clips;
  for (const std::string& id : request.sequence_ids) {
    PLEAT_ASSIGN_OR_RETURN(SequenceInfo info, GetSequence(id));
    clips.push_back(std::move(info));
  }
  draft.sequence_ids = request.sequence_ids;
  draft.options = request.options;
  draft.name = request.model_name.empty() ? clips[0].name : request.model_name;
  if (!request.rig.empty()) {
    PLEAT_ASSIGN_OR_RETURN(const RigFile rig, DecodeUserRig(request.rig));
    PLEAT_RETURN_IF_ERROR(CheckRigCounts(rig, clips[0]));
    draft.rig_id = ToHex(ComputeSha256(request.rig));
    PLEAT_RETURN_IF_ERROR(store_->Add(EntryKind::kRig, {draft.rig_id, ""}, request.rig));
  }
  return jobs_->Create(std::move(draft));
}

absl::StatusOr<RigFile> LocalCharacterService::DecodeUserRig(const std::string& text) const {
  return DecodeRigJson(text, {.max_bytes = options_.limits.max_rig_bytes,
                              .max_vertices = options_.limits.max_vertices});
}

absl::StatusOr<JobInfo> LocalCharacterService::CreateCompressionJob(
    const std::string& sequence_id, const CompressOptions& options) {
  PLEAT_RETURN_IF_ERROR(ValidateCompressOptions(options));
  PLEAT_ASSIGN_OR_RETURN(SequenceInfo info, GetSequence(sequence_id));
  JobInfo draft;
  draft.sequence_ids = {sequence_id};
  draft.options = options;
  draft.name = std::move(info.name);
  return jobs_->Create(std::move(draft));
}

absl::StatusOr<JobOutcome> LocalCharacterService::Run(const JobInfo& job,
                                                      const Progress& progress) {
  if (const auto* training = std::get_if<TrainOptions>(&job.options)) {
    return Train(job, *training, progress);
  }
  return Compress(job, std::get<CompressOptions>(job.options), progress);
}

absl::StatusOr<std::shared_ptr<const CharacterModel>> LocalCharacterService::TrainModel(
    const std::vector<MeshSequence>& clips, const std::string& rig_id, const TrainOptions& options,
    const Progress& progress) const {
  const TrainResources resources{.num_threads = options_.num_threads_per_job};
  if (rig_id.empty()) return options_.train(clips, options, resources, nullptr, progress);
  PLEAT_ASSIGN_OR_RETURN(const std::string text, store_->blobs().Get(rig_id));
  PLEAT_ASSIGN_OR_RETURN(const RigFile file, DecodeUserRig(text));
  PLEAT_ASSIGN_OR_RETURN(const UserRig rig, ResolveRig(file, clips[0]));
  return TrainCharacterWithRig(clips, rig, options, resources, nullptr, progress);
}

absl::StatusOr<JobOutcome> LocalCharacterService::Train(const JobInfo& job,
                                                        const TrainOptions& options,
                                                        const Progress& progress) {
  std::vector<MeshSequence> clips;
  const Progress reading = progress.Stage("read", 0, .02);
  for (const std::string& id : job.sequence_ids) {
    PLEAT_ASSIGN_OR_RETURN(MeshSequence clip, LoadSequence(id));
    clips.push_back(std::move(clip));
    PLEAT_RETURN_IF_ERROR(
        reading.Report(static_cast<double>(clips.size()) / job.sequence_ids.size()));
  }
  PLEAT_ASSIGN_OR_RETURN(std::shared_ptr<const CharacterModel> model,
                         TrainModel(clips, job.rig_id, options, progress.Stage("train", .02, .98)));
  if (model->name() != job.name) {
    CharacterModel::Parts parts = model->parts();
    parts.name = job.name;
    PLEAT_ASSIGN_OR_RETURN(model, CharacterModel::Create(std::move(parts)));
  }
  PLEAT_RETURN_IF_ERROR(progress.Stage("store", .98, 1).Report(0));
  const std::string bytes = EncodeModel(*model);
  const ModelInfo info = MakeModelInfo(*model, ModelId(bytes), bytes.size());
  PLEAT_RETURN_IF_ERROR(store_->Add(EntryKind::kModel, {info.id, EncodeRecord(info)}, bytes));
  return JobOutcome{info.id, model->record().warnings};
}

absl::StatusOr<JobOutcome> LocalCharacterService::Compress(const JobInfo& job,
                                                           CompressOptions options,
                                                           const Progress& progress) {
  PLEAT_RETURN_IF_ERROR(progress.Stage("read", 0, .02).Report(0));
  const std::string& sequence_id = job.sequence_ids.at(0);
  PLEAT_ASSIGN_OR_RETURN(const MeshSequence sequence, LoadSequence(sequence_id));
  options.num_threads = options_.num_threads_per_job;
  PLEAT_ASSIGN_OR_RETURN(MeasuredCompression compressed,
                         CompressMeasured(sequence, options, progress.Stage("compress", .02, .99)));
  PLEAT_RETURN_IF_ERROR(progress.Stage("store", .99, 1).Report(0));
  CompressedSequenceInfo info = {.id = ToHex(ComputeSha256(compressed.bytes)),
                                 .name = sequence.name(),
                                 .num_frames = sequence.num_frames(),
                                 .num_vertices = sequence.num_vertices(),
                                 .num_faces = sequence.topology().num_faces(),
                                 .frame_rate = sequence.frame_rate(),
                                 .size_bytes = compressed.bytes.size(),
                                 .record = std::move(compressed.record)};
  info.record->sequence_id = sequence_id;
  PLEAT_RETURN_IF_ERROR(
      store_->Add(EntryKind::kCompressedSequence, {info.id, EncodeRecord(info)}, compressed.bytes));
  return JobOutcome{info.id, {}};
}

absl::StatusOr<JobInfo> LocalCharacterService::GetJob(const std::string& id) {
  return jobs_->Get(id);
}

absl::StatusOr<std::vector<JobInfo>> LocalCharacterService::ListJobs() { return jobs_->List(); }

absl::Status LocalCharacterService::CancelJob(const std::string& id) { return jobs_->Cancel(id); }

absl::StatusOr<std::shared_ptr<JobStateMachine>> LocalCharacterService::FindJob(
    const std::string& id) {
  return jobs_->Find(id);
}

absl::Status LocalCharacterService::WatchJob(const std::string& id,
                                             const std::function<bool(const JobInfo&)>& observe) {
  PLEAT_ASSIGN_OR_RETURN(const std::shared_ptr<JobStateMachine> job, FindJob(id));
  JobSnapshot snapshot = job->snapshot();
  if (!observe(snapshot.info)) return absl::OkStatus();
  while (!IsFinal(snapshot.info.state)) {
    const JobSnapshot next = job->WaitForChange(snapshot.revision, kWatchWakeSeconds);
    if (next.revision == snapshot.revision) {
      if (shutting_down()) return absl::UnavailableError("the service is shutting down");
    }
    snapshot = next;  // also without news, so that a caller who wants to stop is heard
    if (!observe(snapshot.info)) return absl::OkStatus();
  }
  return absl::OkStatus();
}

}  // namespace pleat
