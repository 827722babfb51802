#include "pleat/local/local_character_service.h"

#include <utility>

#include "pleat/base/status.h"

namespace pleat {

absl::StatusOr<std::unique_ptr<LocalCharacterService>> LocalCharacterService::Open(
    LocalServiceOptions options) {
  PLEAT_ASSIGN_OR_RETURN(std::unique_ptr<Store> store,
                         Store::Open({.data_dir = options.data_dir,
                                      .reserve_bytes = options.reserve_bytes,
                                      .on_problem = options.on_problem}));
  std::unique_ptr<LocalCharacterService> service(
      new LocalCharacterService(options, std::move(store)));
  PLEAT_RETURN_IF_ERROR(service->jobs_.Start());
  if (options.scrub_seconds > 0) {
    service->scrubber_ =
        std::make_unique<Scrubber>(&service->files_.store(), options.scrub_seconds);
  }
  if (options.sweep_seconds > 0) {
    LocalModels* const models = &service->models_;
    service->sweeper_ = std::make_unique<Sweeper>(
        RetentionTarget{.files = &service->files_,
                        .jobs = service->jobs_.retention(),
                        .on_model_removed = [models](const std::string& id) { models->Forget(id); },
                        .on_removed = options.on_removed},
        options.retention, options.sweep_seconds);
  }
  return service;
}

LocalCharacterService::LocalCharacterService(const LocalServiceOptions& options,
                                             std::unique_ptr<Store> store)
    : memory_(options.memory),
      files_(std::move(store), options.limits, options.wall_clock, &memory_.uploads),
      sequences_(&files_),
      model_cache_(options.memory.cache_bytes, &memory_.all),
      models_(&files_, &model_cache_),
      compressed_sequences_(&files_, &memory_.decoders),
      pose_engine_({.encoder_bytes = options.memory.encoder_bytes,
                    .encoder_memory = &memory_.encoders,
                    .num_threads = options.num_pose_threads,
                    .max_batch = options.max_batch}),
      poses_(&models_, &pose_engine_, options.limits.max_frames),
      jobs_(&files_, &sequences_,
            JobRunner(&files_, &sequences_, options.train, options.num_threads_per_job,
                      &memory_.jobs),
            {.num_workers = options.num_workers,
             .max_queued_per_client = options.max_queued_jobs_per_client,
             .in_idle_time = options.jobs_in_idle_time,
             .on_state = options.on_job_state}) {
  memory_.all.AddReclaimer([this](uint64_t bytes) { pose_engine_.encoders().Reclaim(bytes); });
  memory_.all.AddReclaimer([this](uint64_t bytes) { model_cache_.Reclaim(bytes); });
}

double LocalCharacterService::FreeDiskBytes() const {
  const absl::StatusOr<uint64_t> bytes = files_.store().blobs().FreeBytes();
  return bytes.ok() ? static_cast<double>(*bytes) : -1;
}

size_t LocalCharacterService::NumQuarantinedFiles() const {
  const auto files = files_.store().quarantine().List();
  return files.ok() ? files->size() : 0;
}

LocalCharacterService::~LocalCharacterService() { Shutdown(); }

}  // namespace pleat
