// The checkpoints of training jobs, as files of the store.
#pragma once

#include <optional>
#include <string>

#include "pleat/character/training_checkpoint.h"
#include "pleat/local/stored_files.h"
#include "pleat/service/job_service.h"

namespace pleat {

// The checkpoint of one job while it runs. There is one at a time: a new one is stored before the
// old one goes, so a crash leaves one or both of them. What goes wrong never fails the job: it is
// told to the operator, and the job goes on without.
class JobCheckpoints {
 public:
  // job: a training. `files`, of the job's project, must outlive this.
  JobCheckpoints(StoredFiles* files, const JobInfo& job);

  // Returns the newest checkpoint that is whole and was made by this version of the program from
  // the same clips, rig and options. The job's other ones are removed.
  std::optional<TrainingCheckpoint> Load();
  void Save(const TrainingCheckpoint& checkpoint);
  // Removes it because it led to `error`.
  void Discard(const absl::Status& error);

 private:
  void Report(const std::string& what, const absl::Status& why) const;
  std::optional<TrainingCheckpoint> Read(const std::string& id);

  StoredFiles* const files_;
  const std::string job_id_;
  const std::string inputs_;  // CheckpointFile::inputs
  bool is_reported_ = false;  // that it cannot be saved
};

// Removes what is left of a job that has ended. What cannot be removed is reported; the next start
// tries again.
void RemoveCheckpoints(Store& store, const std::string& project, const std::string& job_id);

}  // namespace pleat
