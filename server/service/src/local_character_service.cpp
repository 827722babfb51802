#include "pleat/service/local_character_service.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "infos.h"
#include "pleat/base/status.h"
#include "pleat/character/pose_evaluator.h"
#include "pleat/formats/model_file.h"
#include "pleat/formats/sequence_file.h"
#include "pleat/wire/stored_records.h"

namespace pleat {
namespace {

constexpr double kWatchWakeSeconds = .25;  // how soon a watcher notices a shutdown
constexpr uint64_t kDownloadStepBytes = 8 << 20;

MeshFileLimits FileLimits(const ServiceLimits& limits) {
  return {.max_file_bytes = limits.max_upload_bytes,
          .max_vertices = limits.max_vertices,
          .max_faces = 2 * limits.max_vertices,
          .max_frames = limits.max_frames,
          .max_sequence_bytes = 2 * limits.max_upload_bytes};
}

}  // namespace

absl::StatusOr<std::unique_ptr<LocalCharacterService>> LocalCharacterService::Open(
    LocalServiceOptions options) {
  PLEAT_ASSIGN_OR_RETURN(
      std::unique_ptr<Store> store,
      Store::Open({.data_dir = options.data_dir, .reserve_bytes = options.reserve_bytes}));
  std::unique_ptr<LocalCharacterService> service(
      new LocalCharacterService(std::move(options), std::move(store)));
  PLEAT_RETURN_IF_ERROR(service->RestoreJobs());
  service->jobs_->Start();
  return service;
}

LocalCharacterService::LocalCharacterService(LocalServiceOptions options,
                                             std::unique_ptr<Store> store)
    : options_(std::move(options)), store_(std::move(store)), cache_(options_.cache_bytes) {
  jobs_ = std::make_unique<JobManager>(
      JobManagerOptions{.num_workers = options_.num_workers},
      [this](const JobInfo& job, const Progress& progress) { return Train(job, progress); },
      [this](const JobInfo& info, int attempts) {
        return store_->catalogue().Put(EntryKind::kJob, {info.id, EncodeRecord(info), attempts});
      });
}

LocalCharacterService::~LocalCharacterService() { Shutdown(); }

void LocalCharacterService::Shutdown() { jobs_->Shutdown(); }

absl::Status LocalCharacterService::RestoreJobs() {
  PLEAT_ASSIGN_OR_RETURN(const std::vector<CatalogueEntry> entries,
                         store_->catalogue().List(EntryKind::kJob));
  std::vector<StoredJob> jobs;
  for (const CatalogueEntry& entry : entries) {
    PLEAT_ASSIGN_OR_RETURN(JobInfo info, DecodeJobRecord(entry.record));
    jobs.push_back({std::move(info), entry.attempts});
  }
  jobs_->Restore(std::move(jobs));
  return absl::OkStatus();
}

// --- sequences ---

absl::Status LocalCharacterService::CheckSequence(const MeshSequence& sequence) const {
  const ServiceLimits& limits = options_.limits;
  if (sequence.num_vertices() > limits.max_vertices) {
    return absl::ResourceExhaustedError(absl::StrCat("the sequence has ", sequence.num_vertices(),
                                                     " vertices, the limit (--max-vertices) is ",
                                                     limits.max_vertices));
  }
  if (sequence.num_frames() > limits.max_frames) {
    return absl::ResourceExhaustedError(absl::StrCat("the sequence has ", sequence.num_frames(),
                                                     " frames, the limit (--max-frames) is ",
                                                     limits.max_frames));
  }
  return absl::OkStatus();
}

absl::StatusOr<SequenceInfo> LocalCharacterService::StoreSequence(
    const MeshSequence& sequence, const std::string& id, uint64_t size_bytes,
    const std::function<absl::Status()>& place_file) {
  const SequenceInfo info = MakeSequenceInfo(sequence, id, size_bytes);
  std::lock_guard lock(content_mutex_);
  PLEAT_RETURN_IF_ERROR(place_file());
  PLEAT_RETURN_IF_ERROR(store_->catalogue().Put(EntryKind::kSequence, {id, EncodeRecord(info), 0}));
  return info;
}

absl::StatusOr<SequenceInfo> LocalCharacterService::UploadSequence(const MeshSequence& sequence,
                                                                   const Progress& progress) {
  PLEAT_RETURN_IF_ERROR(CheckSequence(sequence));
  const std::string bytes = EncodeSequence(sequence);
  if (bytes.size() > options_.limits.max_upload_bytes) {
    return absl::ResourceExhaustedError(absl::StrCat("the sequence has ", bytes.size(),
                                                     " bytes, the limit (--max-upload-bytes) is ",
                                                     options_.limits.max_upload_bytes));
  }
  PLEAT_RETURN_IF_ERROR(progress.Report(.5));
  PLEAT_ASSIGN_OR_RETURN(SequenceInfo info,
                         StoreSequence(sequence, SequenceId(bytes), bytes.size(),
                                       [&] { return store_->blobs().Put(bytes).status(); }));
  PLEAT_RETURN_IF_ERROR(progress.Report(1));
  return info;
}

absl::StatusOr<SequenceInfo> LocalCharacterService::GetSequence(const std::string& id) {
  PLEAT_ASSIGN_OR_RETURN(const CatalogueEntry entry,
                         store_->catalogue().Get(EntryKind::kSequence, id));
  return DecodeSequenceRecord(entry.record);
}

absl::StatusOr<std::vector<SequenceInfo>> LocalCharacterService::ListSequences() {
  PLEAT_ASSIGN_OR_RETURN(const std::vector<CatalogueEntry> entries,
                         store_->catalogue().List(EntryKind::kSequence));
  std::vector<SequenceInfo> infos;
  for (const CatalogueEntry& entry : entries) {
    PLEAT_ASSIGN_OR_RETURN(SequenceInfo info, DecodeSequenceRecord(entry.record));
    infos.push_back(std::move(info));
  }
  return infos;
}

absl::Status LocalCharacterService::DeleteEntry(EntryKind kind, const std::string& id) {
  std::lock_guard lock(content_mutex_);
  // Row first: a file without row is removed at the next start, a row without file is an error.
  PLEAT_RETURN_IF_ERROR(store_->catalogue().Delete(kind, id));
  return store_->blobs().Delete(id);
}

absl::Status LocalCharacterService::DeleteSequence(const std::string& id) {
  return DeleteEntry(EntryKind::kSequence, id);
}

absl::StatusOr<UploadStatus> LocalCharacterService::QueryUpload(const std::string& id) {
  const absl::StatusOr<SequenceInfo> stored = GetSequence(id);
  if (stored.ok()) return UploadStatus{stored->size_bytes, true};
  if (stored.status().code() != absl::StatusCode::kNotFound) return stored.status();
  return UploadStatus{store_->uploads().ReceivedBytes(id), false};
}

absl::StatusOr<std::unique_ptr<Upload>> LocalCharacterService::BeginUpload(const std::string& id,
                                                                           uint64_t size_bytes,
                                                                           uint64_t offset_bytes) {
  if (size_bytes == 0) return absl::InvalidArgumentError("an upload of 0 bytes is no sequence");
  if (size_bytes > options_.limits.max_upload_bytes) {
    return absl::ResourceExhaustedError(absl::StrCat("the upload has ", size_bytes,
                                                     " bytes, the limit (--max-upload-bytes) is ",
                                                     options_.limits.max_upload_bytes));
  }
  if (offset_bytes > size_bytes) {
    return absl::OutOfRangeError(absl::StrCat(
        "offset ", offset_bytes, " is behind the end of an upload of ", size_bytes, " bytes"));
  }
  PLEAT_RETURN_IF_ERROR(store_->blobs().CheckSpace(size_bytes - offset_bytes));
  return store_->uploads().Begin(id, size_bytes, offset_bytes);
}

absl::StatusOr<SequenceInfo> LocalCharacterService::FinishUpload(Upload* upload) {
  PLEAT_ASSIGN_OR_RETURN(const std::string bytes, upload->ReadComplete());
  absl::StatusOr<MeshSequence> sequence = DecodeSequence(bytes, FileLimits(options_.limits));
  absl::Status status = sequence.status();
  if (status.ok()) status = CheckSequence(*sequence);
  if (!status.ok()) {
    upload->Discard();  // these bytes will never be a sequence
    return status;
  }
  return StoreSequence(*sequence, upload->id(), bytes.size(),
                       [&] { return upload->MoveTo(&store_->blobs()); });
}

absl::StatusOr<MeshSequence> LocalCharacterService::LoadSequence(const std::string& id) {
  PLEAT_RETURN_IF_ERROR(GetSequence(id).status());
  PLEAT_ASSIGN_OR_RETURN(const std::string bytes, store_->blobs().Get(id));
  return DecodeSequence(bytes, FileLimits(options_.limits));
}

// --- jobs ---

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
    if (draft.model_name.empty()) draft.model_name = info.name;
  }
  draft.sequence_ids = sequence_ids;
  draft.options = options;
  if (!model_name.empty()) draft.model_name = model_name;
  return jobs_->Create(std::move(draft));
}

absl::StatusOr<JobOutcome> LocalCharacterService::Train(const JobInfo& job,
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
      options_.train(clips, job.options, {.num_threads = options_.num_threads_per_job}, nullptr,
                     progress.Stage("train", .02, .98)));
  if (model->name() != job.model_name) {
    CharacterModel::Parts parts = model->parts();
    parts.name = job.model_name;
    PLEAT_ASSIGN_OR_RETURN(model, CharacterModel::Create(std::move(parts)));
  }
  PLEAT_RETURN_IF_ERROR(progress.Stage("store", .98, 1).Report(0));
  PLEAT_ASSIGN_OR_RETURN(std::string id, StoreModel(*model));
  return JobOutcome{std::move(id), model->record().warnings};
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

// --- models ---

absl::StatusOr<std::string> LocalCharacterService::StoreModel(const CharacterModel& model) {
  const std::string bytes = EncodeModel(model);
  const ModelInfo info = MakeModelInfo(model, ModelId(bytes), bytes.size());
  std::lock_guard lock(content_mutex_);
  PLEAT_RETURN_IF_ERROR(store_->blobs().Put(bytes).status());
  PLEAT_RETURN_IF_ERROR(
      store_->catalogue().Put(EntryKind::kModel, {info.id, EncodeRecord(info), 0}));
  return info.id;
}

absl::StatusOr<ModelInfo> LocalCharacterService::GetModel(const std::string& id) {
  PLEAT_ASSIGN_OR_RETURN(const CatalogueEntry entry,
                         store_->catalogue().Get(EntryKind::kModel, id));
  return DecodeModelRecord(entry.record);
}

absl::StatusOr<std::vector<ModelInfo>> LocalCharacterService::ListModels() {
  PLEAT_ASSIGN_OR_RETURN(const std::vector<CatalogueEntry> entries,
                         store_->catalogue().List(EntryKind::kModel));
  std::vector<ModelInfo> infos;
  for (const CatalogueEntry& entry : entries) {
    PLEAT_ASSIGN_OR_RETURN(ModelInfo info, DecodeModelRecord(entry.record));
    infos.push_back(std::move(info));
  }
  return infos;
}

absl::Status LocalCharacterService::DeleteModel(const std::string& id) {
  PLEAT_RETURN_IF_ERROR(DeleteEntry(EntryKind::kModel, id));
  cache_.Erase(id);
  return absl::OkStatus();
}

absl::StatusOr<std::string> LocalCharacterService::ReadModelBytes(const std::string& id,
                                                                  uint64_t offset, uint64_t count) {
  PLEAT_RETURN_IF_ERROR(store_->catalogue().Get(EntryKind::kModel, id).status());
  return store_->blobs().GetRange(id, offset, count);
}

absl::StatusOr<std::string> LocalCharacterService::DownloadModel(const std::string& id,
                                                                 const Progress& progress) {
  PLEAT_ASSIGN_OR_RETURN(const ModelInfo info, GetModel(id));
  std::string bytes;
  while (bytes.size() < info.size_bytes) {
    PLEAT_ASSIGN_OR_RETURN(const std::string part,
                           store_->blobs().GetRange(id, bytes.size(), kDownloadStepBytes));
    if (part.empty()) return absl::DataLossError(absl::StrCat("model '", id, "' is cut off"));
    bytes += part;
    PLEAT_RETURN_IF_ERROR(progress.Report(static_cast<double>(bytes.size()) / info.size_bytes));
  }
  return bytes;
}

absl::StatusOr<std::shared_ptr<const CharacterModel>> LocalCharacterService::AcquireModel(
    const std::string& id) {
  using Loaded = ByteCache<CharacterModel>::Loaded;
  return cache_.Get(id, [this](const std::string& key) -> absl::StatusOr<Loaded> {
    PLEAT_RETURN_IF_ERROR(store_->catalogue().Get(EntryKind::kModel, key).status());
    PLEAT_ASSIGN_OR_RETURN(const std::string bytes, store_->blobs().Get(key));
    PLEAT_ASSIGN_OR_RETURN(std::shared_ptr<const CharacterModel> model, DecodeModel(bytes));
    const uint64_t charge = model->memory_bytes();
    return Loaded{std::move(model), charge};
  });
}

// --- poses ---

absl::Status LocalCharacterService::CheckClip(const PoseTrack& track) const {
  if (track.num_frames() <= options_.limits.max_frames) return absl::OkStatus();
  return absl::ResourceExhaustedError(absl::StrCat("the clip has ", track.num_frames(),
                                                   " frames, the limit (--max-frames) is ",
                                                   options_.limits.max_frames));
}

absl::StatusOr<std::unique_ptr<PoseSession>> LocalCharacterService::OpenSession(
    const std::string& model_id, PoseSessionOptions options) {
  PLEAT_ASSIGN_OR_RETURN(std::shared_ptr<const CharacterModel> model, AcquireModel(model_id));
  return PoseSession::Open(std::move(model), std::move(options));
}

absl::StatusOr<std::unique_ptr<ClipSession>> LocalCharacterService::OpenClip(
    const std::string& model_id, PoseTrack track, PoseSessionOptions options) {
  PLEAT_RETURN_IF_ERROR(CheckClip(track));
  PLEAT_ASSIGN_OR_RETURN(std::shared_ptr<const CharacterModel> model, AcquireModel(model_id));
  return ClipSession::Open(std::move(model), std::move(track), std::move(options));
}

absl::Status LocalCharacterService::EvaluateClip(
    const ClipQuery& query,
    const std::function<absl::Status(int frame_index, const EvaluatedFrame&)>& consume) {
  PLEAT_RETURN_IF_ERROR(CheckClip(query.track));
  PLEAT_ASSIGN_OR_RETURN(std::shared_ptr<const CharacterModel> model, AcquireModel(query.model_id));
  PoseEvaluator evaluator(std::move(model));
  if (!query.skinned_only) return evaluator.EvaluateClip(query.track, query.bone_scales, consume);
  EvaluatedFrame frame;
  for (int t = 0; t < query.track.num_frames(); ++t) {
    PLEAT_RETURN_IF_ERROR(
        evaluator.EvaluateSkinned(query.track.poses[t], query.bone_scales, &frame));
    PLEAT_RETURN_IF_ERROR(consume(t, frame));
  }
  return absl::OkStatus();
}

}  // namespace pleat
