// The five services as one project sees them.
#pragma once

#include <memory>
#include <string>

#include "pleat/local/job_pool.h"
#include "pleat/local/local_compressed_sequences.h"
#include "pleat/local/local_jobs.h"
#include "pleat/local/local_models.h"
#include "pleat/local/local_poses.h"
#include "pleat/local/local_sequences.h"
#include "pleat/local/memory_owners.h"
#include "pleat/local/project_quota.h"
#include "pleat/service/character_service.h"

namespace pleat {

// The same for each project of a server.
struct ProjectLimits {
  // Whether an upload ends at once when another project has the same content. Whoever knows the
  // SHA-256 of a file can then take it over.
  bool share_content = false;
  uint64_t max_bytes = 0;               // of stored files; 0: no limit
  int max_queued_jobs = 0;              // that wait; 0: no limit
  double frames_per_second = 0;         // evaluated and decoded ones together; 0: no limit
  double job_cpu_seconds_per_hour = 0;  // processor time of its jobs; 0: no limit
};

// What all projects of a process share: none of it can be reached with an id alone. All of it must
// outlive the projects.
struct SharedByProjects {
  std::shared_ptr<Store> store{};
  MemoryOwners* memory = nullptr;
  ModelCache* model_cache = nullptr;  // by content; a model is only given to who has its row
  PoseEngine* pose_engine = nullptr;
  JobPool* jobs = nullptr;
};

struct LocalProjectOptions {
  std::string name = kDefaultProject;
  ServiceLimits limits{};
  ProjectLimits project{};
  WallClock wall_clock = SystemTime;
  TrainFunction train = TrainCharacter;
  int num_threads_per_job = 0;
};

// Thread-safe.
class LocalProject final : public CharacterService {
 public:
  LocalProject(const SharedByProjects& shared, const LocalProjectOptions& options);

  LocalSequences& sequences() override { return sequences_; }
  LocalJobs& jobs() override { return jobs_; }
  LocalModels& models() override { return models_; }
  LocalPoses& poses() override { return poses_; }
  LocalCompressedSequences& compressed_sequences() override { return compressed_sequences_; }

  StoredFiles& files() { return files_; }
  const JobRunner& runner() const { return jobs_.runner(); }
  const ProjectQuota& frames() const { return frames_; }
  ProjectQuota& job_time() { return job_time_; }

 private:
  StoredFiles files_;
  ProjectQuota frames_, job_time_;
  LocalSequences sequences_;
  LocalModels models_;
  LocalCompressedSequences compressed_sequences_;
  LocalPoses poses_;
  LocalJobs jobs_;
};

}  // namespace pleat
