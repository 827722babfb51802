#include "pleat/local/local_character_service.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"
#include "pleat/character/pose_evaluator.h"
#include "pleat/formats/model_file.h"
#include "stored_infos.h"

namespace pleat {
namespace {

constexpr uint64_t kDownloadStepBytes = 8 << 20;

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
    : options_(std::move(options)),
      store_(std::move(store)),
      cache_(options_.cache_bytes),
      decode_memory_(options_.decode_bytes, "--decode-bytes"),
      encoders_(options_.encoder_bytes) {
  jobs_ = std::make_unique<JobManager>(
      JobManagerOptions{.num_workers = options_.num_workers},
      [this](const JobInfo& job, const Progress& progress) { return Run(job, progress); },
      [this](const JobInfo& info, int attempts) {
        return store_->catalogue().Put(EntryKind::kJob, {info.id, EncodeRecord(info), attempts});
      });
}

LocalCharacterService::~LocalCharacterService() { Shutdown(); }

void LocalCharacterService::Shutdown() { jobs_->Shutdown(); }

// --- stored files ---

absl::StatusOr<std::string> LocalCharacterService::ReadStoredBytes(EntryKind kind,
                                                                   const std::string& id,
                                                                   uint64_t offset,
                                                                   uint64_t count) {
  PLEAT_RETURN_IF_ERROR(store_->catalogue().Get(kind, id).status());
  return store_->blobs().GetRange(id, offset, count);
}

absl::StatusOr<std::string> LocalCharacterService::Download(EntryKind kind, const std::string& id,
                                                            uint64_t size_bytes,
                                                            const Progress& progress) {
  std::string bytes;
  while (bytes.size() < size_bytes) {
    PLEAT_ASSIGN_OR_RETURN(const std::string part,
                           ReadStoredBytes(kind, id, bytes.size(), kDownloadStepBytes));
    if (part.empty()) return absl::DataLossError(absl::StrCat("the file '", id, "' is cut off"));
    bytes += part;
    PLEAT_RETURN_IF_ERROR(progress.Report(static_cast<double>(bytes.size()) / size_bytes));
  }
  return bytes;
}

// --- models ---

absl::StatusOr<ModelInfo> LocalCharacterService::GetModel(const std::string& id) {
  return GetStored<ModelInfo>(store_->catalogue(), id);
}

absl::StatusOr<std::vector<ModelInfo>> LocalCharacterService::ListModels() {
  return ListStored<ModelInfo>(store_->catalogue());
}

absl::Status LocalCharacterService::DeleteModel(const std::string& id) {
  PLEAT_RETURN_IF_ERROR(store_->Delete(EntryKind::kModel, id));
  cache_.Erase(id);
  return absl::OkStatus();
}

absl::StatusOr<std::string> LocalCharacterService::DownloadModel(const std::string& id,
                                                                 const Progress& progress) {
  PLEAT_ASSIGN_OR_RETURN(const ModelInfo info, GetModel(id));
  return Download(EntryKind::kModel, id, info.size_bytes, progress);
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
  PLEAT_ASSIGN_OR_RETURN(std::unique_ptr<EncoderPool::Lease> encoder,
                         encoders_.Take(model_id, *model, options.encoder));
  return PoseSession::Open(std::move(model), std::move(options), std::move(encoder));
}

absl::StatusOr<std::unique_ptr<ClipSession>> LocalCharacterService::OpenClip(
    const std::string& model_id, PoseTrack track, PoseSessionOptions options) {
  PLEAT_RETURN_IF_ERROR(CheckClip(track));
  PLEAT_ASSIGN_OR_RETURN(std::shared_ptr<const CharacterModel> model, AcquireModel(model_id));
  PLEAT_ASSIGN_OR_RETURN(std::unique_ptr<EncoderPool::Lease> encoder,
                         encoders_.Take(model_id, *model, options.encoder));
  return ClipSession::Open(std::move(model), std::move(track), std::move(options),
                           std::move(encoder));
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
