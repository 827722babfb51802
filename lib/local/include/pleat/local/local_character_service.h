// Everything that Pleat offers, in this process: store, jobs and cache behind the five interfaces.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "pleat/local/local_project.h"
#include "pleat/local/memory_owners.h"
#include "pleat/local/scrubber.h"
#include "pleat/local/sweeper.h"
#include "pleat/service/character_service.h"

namespace pleat {

struct LocalServiceOptions {
  std::string data_dir{};
  uint64_t reserve_bytes = uint64_t{256} << 20;  // space that is kept free on the disk
  int num_workers = 1;                           // jobs that run at the same time
  int max_queued_jobs_per_client = 250;
  int num_threads_per_job = 0;     // 0 = one per core
  bool jobs_in_idle_time = false;  // jobs take what live sessions leave
  int num_pose_threads = 0;        // 0 = one per core
  int max_batch = 8;               // live poses of a model evaluated together
  MemoryLimits memory{};
  double scrub_seconds = 0;  // in which every stored file is read once and verified; 0 = never
  double sweep_seconds = 0;  // between two runs of retention; 0 = never
  RetentionRules retention{};
  ServiceLimits limits{};
  ProjectLimits project{};            // the same for each
  WallClock wall_clock = SystemTime;  // for the times that entries and jobs keep
  TrainFunction train = TrainCharacter;
  // Receives sentences for the operator (StoreOptions::on_problem).
  std::function<void(const std::string& problem)> on_problem{};
  // Receives a job whenever a new state of it has been saved.
  std::function<void(const JobInfo& job)> on_job_state{};
  // Hears how long a job was in a stage, when it leaves it.
  std::function<void(const std::string& stage, double seconds)> on_job_stage{};
  // Receives one sentence about each thing that retention removed.
  std::function<void(const std::string& sentence)> on_removed{};
};

// What one project has and has used.
struct ProjectUse {
  std::string project{};
  uint64_t stored_bytes = 0;
  std::map<std::string, size_t> jobs{};  // by JobStateName
  // Since the start of the process:
  double frames = 0;           // evaluated and decoded
  double job_cpu_seconds = 0;  // processor time of its jobs
};

// Owns the data folder, the five services over it for each project, and their threads. As a
// CharacterService it is that of the default project. Thread-safe.
class LocalCharacterService final : public CharacterService {
 public:
  // Opens the data folder, takes over the jobs of the process before, and starts the workers.
  // Returns the errors of the store, such as a folder that another process uses.
  static absl::StatusOr<std::unique_ptr<LocalCharacterService>> Open(LocalServiceOptions options);
  ~LocalCharacterService() override;

  // The services of a project, made when they are first asked for; they live as long as this
  // object. The name must be good (CheckProjectName).
  LocalProject& OfProject(const std::string& name);

  LocalSequences& sequences() override { return default_->sequences(); }
  LocalJobs& jobs() override { return default_->jobs(); }
  LocalModels& models() override { return default_->models(); }
  LocalPoses& poses() override { return default_->poses(); }
  LocalCompressedSequences& compressed_sequences() override {
    return default_->compressed_sequences();
  }

  // Everything that this process promises of its memory; a server charges its own share to it.
  MemoryOwners& memory() { return memory_; }
  uint64_t model_bytes() const { return model_cache_.stats().used_bytes; }
  size_t CountJobsInState(JobState state) const { return jobs_->CountInState(state); }

  // The ids of entries whose file was gone when the data folder was opened.
  const std::vector<std::string>& missing_files() const { return store_->missing_files(); }

  // Of every project that has or had something, or was asked for since the start; by name.
  std::vector<ProjectUse> ProjectUses();

  // For an operator. Free bytes of the disk: -1 when it does not answer.
  double FreeDiskBytes() const;
  size_t NumQuarantinedFiles() const;
  // Why nothing can be stored at the moment (Store::ProbeDisk).
  absl::Status ProbeDisk() { return store_->ProbeDisk(); }

  // Stops the workers and ends all subscriptions. Jobs that run are queued for the next process.
  void Shutdown() { jobs_->Shutdown(); }

 private:
  LocalCharacterService(const LocalServiceOptions& options, std::unique_ptr<Store> store);

  const LocalServiceOptions options_;
  // In this order, because members are destroyed from the last to the first: the jobs and the
  // poses, which have threads, end before what their threads use. The jobs come last, because their
  // workers ask for projects.
  MemoryOwners memory_;
  const std::shared_ptr<Store> store_;
  ModelCache model_cache_;
  PoseEngine pose_engine_;
  std::unique_ptr<StoredFiles> reporter_;  // through which the jobs reach the store
  std::mutex projects_mutex_;
  std::map<std::string, std::unique_ptr<LocalProject>> projects_;  // guarded by projects_mutex_
  LocalProject* default_ = nullptr;
  std::unique_ptr<JobPool> jobs_;
  std::unique_ptr<Scrubber> scrubber_;  // null: never
  std::unique_ptr<Sweeper> sweeper_;    // null: never
};

}  // namespace pleat
