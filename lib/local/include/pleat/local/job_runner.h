// The work of jobs: training a model, or compressing a sequence.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/base/memory_budget.h"
#include "pleat/base/progress.h"
#include "pleat/character/train_character.h"
#include "pleat/formats/rig_file.h"
#include "pleat/jobs/job_manager.h"
#include "pleat/local/local_sequences.h"
#include "pleat/local/stored_files.h"

namespace pleat {

using TrainFunction = std::function<absl::StatusOr<std::shared_ptr<const CharacterModel>>(
    const std::vector<MeshSequence>& clips, const TrainOptions& options,
    const TrainResources& resources, TrainSummary* summary, const Progress& progress)>;

// Runs jobs on the threads of its callers, several at a time. Thread-safe. `files` and `sequences`
// must outlive it.
class JobRunner {
 public:
  // train: how a job without a rig of its own is trained; tests put their own function here.
  // num_threads: the threads of one job, 0 = one per core.
  // memory: of all jobs together; a job waits until there is enough for it. Null: not counted.
  JobRunner(StoredFiles* files, LocalSequences* sequences, TrainFunction train, int num_threads,
            MemoryBudget* memory = nullptr)
      : files_(files),
        sequences_(sequences),
        train_(std::move(train)),
        num_threads_(num_threads),
        memory_(memory) {}

  // Does the work of the job and stores its result. A training goes on where another process that
  // ran the same job came to (job_checkpoints.h), with the same result. Returns the errors of
  // reading, training or compressing, and kCancelled when `progress` was cancelled.
  absl::StatusOr<JobOutcome> Run(const JobInfo& job, const Progress& progress) const;
  // kResourceExhausted when a job on these sequences needs more memory than all jobs may ever have.
  absl::Status CheckMemory(const JobOptions& options, const std::vector<SequenceInfo>& clips) const;
  // Reads a user's rig (JSON) under the limits of the service.
  absl::StatusOr<RigFile> DecodeUserRig(const std::string& text) const;

 private:
  absl::StatusOr<std::shared_ptr<const CharacterModel>> TrainModel(
      const std::vector<MeshSequence>& clips, const std::string& rig_id,
      const TrainOptions& options, const TrainResources& resources, const Progress& progress) const;
  absl::StatusOr<std::shared_ptr<const CharacterModel>> TrainFromCheckpoint(
      const std::vector<MeshSequence>& clips, const JobInfo& job, const TrainOptions& options,
      const Progress& progress) const;
  // Waits for the memory of the job.
  absl::StatusOr<Reservation> TakeMemory(const JobInfo& job, const Progress& progress) const;
  absl::StatusOr<JobOutcome> Train(const JobInfo& job, const TrainOptions& options,
                                   const Progress& progress) const;
  absl::StatusOr<JobOutcome> Compress(const JobInfo& job, CompressOptions options,
                                      const Progress& progress) const;

  StoredFiles* const files_;
  LocalSequences* const sequences_;
  const TrainFunction train_;
  const int num_threads_;
  MemoryBudget* const memory_;
};

}  // namespace pleat
