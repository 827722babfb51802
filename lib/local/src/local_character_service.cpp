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
  PLEAT_RETURN_IF_ERROR(service->jobs_->Start());
  if (options.scrub_seconds > 0) {
    service->scrubber_ = std::make_unique<Scrubber>(service->store_.get(), options.scrub_seconds);
  }
  if (options.sweep_seconds > 0) {
    ModelCache* const models = &service->model_cache_;
    service->sweeper_ = std::make_unique<Sweeper>(
        RetentionTarget{.files = &service->default_->files(),
                        .on_model_removed = [models](const std::string& id) { models->Erase(id); },
                        .on_removed = options.on_removed},
        options.retention, options.sweep_seconds);
  }
  return service;
}

LocalCharacterService::LocalCharacterService(const LocalServiceOptions& options,
                                             std::unique_ptr<Store> store)
    : options_(options),
      memory_(options.memory),
      store_(std::move(store)),
      model_cache_(options.memory.cache_bytes, &memory_.all),
      pose_engine_({.encoder_bytes = options.memory.encoder_bytes,
                    .encoder_memory = &memory_.encoders,
                    .num_threads = options.num_pose_threads,
                    .max_batch = options.max_batch}) {
  memory_.all.AddReclaimer([this](uint64_t bytes) { pose_engine_.encoders().Reclaim(bytes); });
  memory_.all.AddReclaimer([this](uint64_t bytes) { model_cache_.Reclaim(bytes); });
  reporter_ = std::make_unique<StoredFiles>(store_, options.limits, options.wall_clock);
  jobs_ = std::make_unique<JobPool>(
      reporter_.get(),
      [this](const std::string& project) -> const JobRunner& {
        return OfProject(project).runner();
      },
      JobPoolOptions{.num_workers = options.num_workers,
                     .max_queued_per_client = options.max_queued_jobs_per_client,
                     .max_queued_per_project = options.project.max_queued_jobs,
                     .in_idle_time = options.jobs_in_idle_time,
                     .on_state = options.on_job_state,
                     .on_stage = options.on_job_stage,
                     .on_processor_time =
                         [this](const std::string& project, double seconds) {
                           OfProject(project).job_time().Charge(seconds);
                         },
                     .waiting_time =
                         [this](const std::string& project) {
                           return OfProject(project).job_time().TimeUntilFree();
                         }});
  default_ = &OfProject(kDefaultProject);
}

LocalProject& LocalCharacterService::OfProject(const std::string& name) {
  std::lock_guard lock(projects_mutex_);
  std::unique_ptr<LocalProject>& project = projects_[name];
  if (project == nullptr) {
    project = std::make_unique<LocalProject>(
        SharedByProjects{.store = store_,
                         .memory = &memory_,
                         .model_cache = &model_cache_,
                         .pose_engine = &pose_engine_,
                         .jobs = jobs_.get()},
        LocalProjectOptions{.name = name,
                            .limits = options_.limits,
                            .project = options_.project,
                            .wall_clock = options_.wall_clock,
                            .train = options_.train,
                            .num_threads_per_job = options_.num_threads_per_job});
  }
  return *project;
}

std::vector<ProjectUse> LocalCharacterService::ProjectUses() {
  std::map<std::string, ProjectUse> uses;
  if (const auto bytes = store_->catalog().ListProjectBytes(); bytes.ok()) {
    for (const auto& [project, stored] : *bytes) uses[project].stored_bytes = stored;
  }
  if (const auto counts = store_->catalog().CountJobs(); counts.ok()) {
    for (const Catalog::JobCount& count : *counts) {
      uses[count.project].jobs[count.state] = static_cast<size_t>(count.num);
    }
  }
  {
    std::lock_guard lock(projects_mutex_);
    for (const auto& [name, project] : projects_) {
      uses[name].frames = project->frames().used();
      uses[name].job_cpu_seconds = project->job_time().used();
    }
  }
  std::vector<ProjectUse> list;
  for (auto& [name, use] : uses) {
    use.project = name;
    list.push_back(std::move(use));
  }
  return list;
}

double LocalCharacterService::FreeDiskBytes() const {
  const absl::StatusOr<uint64_t> bytes = store_->blobs().FreeBytes();
  return bytes.ok() ? static_cast<double>(*bytes) : -1;
}

size_t LocalCharacterService::NumQuarantinedFiles() const {
  const auto files = store_->quarantine().List();
  return files.ok() ? files->size() : 0;
}

LocalCharacterService::~LocalCharacterService() { Shutdown(); }

}  // namespace pleat
