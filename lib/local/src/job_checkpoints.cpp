#include "job_checkpoints.h"

#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "pleat/base/sha256.h"
#include "pleat/base/status.h"
#include "pleat/character/train_options.h"
#include "pleat/formats/checkpoint_file.h"
#include "pleat/service/limits.h"
#include "pleat/store/records.h"

namespace pleat {
namespace {

// Other versions of the program may compute other numbers from the same inputs.
std::string InputsOf(const JobInfo& job) {
  std::string text = absl::StrCat("pleat=", PLEAT_VERSION, "\n",
                                  FormatTrainOptions(std::get<TrainOptions>(job.options)));
  for (const std::string& id : job.sequence_ids) absl::StrAppend(&text, "sequence=", id, "\n");
  absl::StrAppend(&text, "rig=", job.rig_id, "\n");
  return text;
}

// The ids of the checkpoints of a job, oldest first.
absl::StatusOr<std::vector<std::string>> CheckpointsOf(Store& store, const std::string& project,
                                                       const std::string& job_id) {
  std::vector<std::string> ids;
  for (int64_t after = 0;;) {
    PLEAT_ASSIGN_OR_RETURN(
        const std::vector<CatalogEntry> entries,
        store.catalog().ListPage({EntryKind::kCheckpoint, project}, after, kMaxPageSize));
    if (entries.empty()) return ids;
    after = entries.back().position;
    for (const CatalogEntry& entry : entries) {
      const absl::StatusOr<CheckpointInfo> info = DecodeCheckpointRecord(entry.record);
      if (info.ok() && info->job_id == job_id) ids.push_back(entry.id);
    }
  }
}

// Removes all of them but `kept_id`.
void RemoveOthers(Store& store, const std::string& project, const std::string& job_id,
                  const std::string& kept_id) {
  const absl::StatusOr<std::vector<std::string>> ids = CheckpointsOf(store, project, job_id);
  absl::Status status = ids.status();
  if (ids.ok()) {
    for (const std::string& id : *ids) {
      if (id != kept_id) status.Update(store.Delete({EntryKind::kCheckpoint, project}, id));
    }
  }
  if (status.ok() || absl::IsNotFound(status)) return;
  store.Report(absl::StrCat("a checkpoint of job '", job_id,
                            "' cannot be removed: ", std::string(status.message())));
}

}  // namespace

JobCheckpoints::JobCheckpoints(StoredFiles* files, const JobInfo& job)
    : files_(files), job_id_(job.id), inputs_(InputsOf(job)) {}

void JobCheckpoints::Report(const std::string& what, const absl::Status& why) const {
  files_->store().Report(
      absl::StrCat("job '", job_id_, "' ", what, ": ", std::string(why.message())));
}

std::optional<TrainingCheckpoint> JobCheckpoints::Load() {
  const auto ids = CheckpointsOf(files_->store(), files_->project(), job_id_);
  if (!ids.ok()) Report("begins anew, its checkpoint cannot be found", ids.status());
  if (!ids.ok() || ids->empty()) return std::nullopt;
  std::optional<TrainingCheckpoint> checkpoint = Read(ids->back());
  RemoveOthers(files_->store(), files_->project(), job_id_, checkpoint ? ids->back() : "");
  return checkpoint;
}

std::optional<TrainingCheckpoint> JobCheckpoints::Read(const std::string& id) {
  const absl::StatusOr<std::string> bytes = files_->Read(id);
  absl::StatusOr<CheckpointFile> file =
      bytes.ok() ? DecodeCheckpoint(*bytes) : absl::StatusOr<CheckpointFile>(bytes.status());
  if (file.ok() && (file->job_id != job_id_ || file->inputs != inputs_)) {
    file = absl::FailedPreconditionError(
        "another version of the program made it, or from something else");
  }
  if (file.ok()) return std::move(file->checkpoint);
  Report("begins anew, its checkpoint cannot be used", file.status());
  return std::nullopt;
}

void JobCheckpoints::Save(const TrainingCheckpoint& checkpoint) {
  if (job_id_.empty() || inputs_.size() > kMaxCheckpointInputsBytes) return;
  const std::string bytes =
      EncodeCheckpoint({.job_id = job_id_, .inputs = inputs_, .checkpoint = checkpoint});
  const std::string id = ToHex(ComputeSha256(bytes));
  const absl::StatusOr<SpaceReservation> room = files_->ReserveRoom(bytes.size());
  absl::Status status = room.status();
  if (status.ok()) {
    status = files_->Add(EntryKind::kCheckpoint,
                         {id, EncodeRecord(CheckpointInfo{.job_id = job_id_})}, bytes);
  }
  if (status.ok()) {
    RemoveOthers(files_->store(), files_->project(), job_id_, id);
  } else if (!std::exchange(is_reported_, true)) {
    Report("would begin anew after a restart, its checkpoint cannot be saved", status);
  }
}

void JobCheckpoints::Discard(const absl::Status& error) {
  Report("begins anew, its checkpoint led to an error", error);
  RemoveCheckpoints(files_->store(), files_->project(), job_id_);
}

void RemoveCheckpoints(Store& store, const std::string& project, const std::string& job_id) {
  RemoveOthers(store, project, job_id, "");
}

}  // namespace pleat
