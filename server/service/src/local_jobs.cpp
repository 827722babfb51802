// Jobs: what they are made of and what they do.
#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "infos.h"
#include "pleat/base/sha256.h"
#include "pleat/base/status.h"
#include "pleat/formats/model_file.h"
#include "pleat/service/compression.h"
#include "pleat/service/local_character_service.h"
#include "pleat/wire/stored_records.h"

namespace pleat {
namespace {

constexpr double kWatchWakeSeconds = .25;  // how soon a watcher notices a shutdown

}  // namespace

absl::StatusOr<JobInfo> LocalCharacterService::CreateTrainingJob(
    const std::vector<std::string>& sequence_ids, const TrainOptions& options,
    const std::string& model_name) {
  PLEAT_RETURN_IF_ERROR(ValidateTrainOptions(options));
  if (sequence_ids.empty() ||
      sequence_ids.size() > static_cast<size_t>(options_.limits.max_clips)) {
    return absl::InvalidArgumentError(absl::StrCat("a training job needs 1 to ",
                                                   options_.limits.max_clips, " sequences, not ",
                                                   sequence_ids.size()));
  }
  JobInfo draft;
  for (const std::string& id : sequence_ids) {
    PLEAT_ASSIGN_OR_RETURN(const SequenceInfo info, GetSequence(id));
    if (draft.name.empty()) draft.name = info.name;
  }
  draft.sequence_ids = sequence_ids;
  draft.options = options;
  if (!model_name.empty()) draft.name = model_name;
  return jobs_->Create(std::move(draft));
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
  PLEAT_ASSIGN_OR_RETURN(
      std::shared_ptr<const CharacterModel> model,
      options_.train(clips, options, {.num_threads = options_.num_threads_per_job}, nullptr,
                     progress.Stage("train", .02, .98)));
  if (model->name() != job.name) {
    CharacterModel::Parts parts = model->parts();
    parts.name = job.name;
    PLEAT_ASSIGN_OR_RETURN(model, CharacterModel::Create(std::move(parts)));
  }
  PLEAT_RETURN_IF_ERROR(progress.Stage("store", .98, 1).Report(0));
  const std::string bytes = EncodeModel(*model);
  const ModelInfo info = MakeModelInfo(*model, ModelId(bytes), bytes.size());
  PLEAT_RETURN_IF_ERROR(AddEntry(EntryKind::kModel, info.id, EncodeRecord(info),
                                 [&] { return store_->blobs().Put(bytes).status(); }));
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
  PLEAT_RETURN_IF_ERROR(AddEntry(EntryKind::kCompressedSequence, info.id, EncodeRecord(info),
                                 [&] { return store_->blobs().Put(compressed.bytes).status(); }));
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
