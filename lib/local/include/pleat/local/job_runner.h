// What jobs do: train a model, or compress a sequence.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
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

// Thread-safe. `files` and `sequences` must outlive it.
class JobRunner {
 public:
  // num_threads: of one job, 0 = one per core.
  JobRunner(StoredFiles* files, LocalSequences* sequences, TrainFunction train, int num_threads)
      : files_(files), sequences_(sequences), train_(std::move(train)), num_threads_(num_threads) {}

  // Does the work of the job and stores its result.
  absl::StatusOr<JobOutcome> Run(const JobInfo& job, const Progress& progress) const;
  // Reads a user's rig under the limits of the service.
  absl::StatusOr<RigFile> DecodeUserRig(const std::string& text) const;

 private:
  absl::StatusOr<std::shared_ptr<const CharacterModel>> TrainModel(
      const std::vector<MeshSequence>& clips, const std::string& rig_id,
      const TrainOptions& options, const Progress& progress) const;
  absl::StatusOr<JobOutcome> Train(const JobInfo& job, const TrainOptions& options,
                                   const Progress& progress) const;
  absl::StatusOr<JobOutcome> Compress(const JobInfo& job, CompressOptions options,
                                      const Progress& progress) const;

  StoredFiles* const files_;
  LocalSequences* const sequences_;
  const TrainFunction train_;
  const int num_threads_;
};

}  // namespace pleat
