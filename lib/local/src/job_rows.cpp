#include "job_rows.h"

#include <utility>

#include "job_checkpoints.h"
#include "pleat/base/status.h"
#include "pleat/store/records.h"
#include "stored_infos.h"

namespace pleat {
namespace {

// Rows of older versions that are in memory together while their states are noted.
constexpr int kNotedTogether = 1000;

absl::StatusOr<StoredJob> StoredJobOf(const CatalogEntry& entry) {
  PLEAT_ASSIGN_OR_RETURN(JobInfo info, InfoOf<JobInfo>(entry));
  return StoredJob{std::move(info), entry.attempts};
}

// The columns of the entry, from its record.
absl::Status NoteState(CatalogEntry* entry) {
  PLEAT_ASSIGN_OR_RETURN(const StoredJob stored, StoredJobOf(*entry));
  entry->job = JobEntry(stored.info, stored.attempts).job;
  return absl::OkStatus();
}

// False when some row cannot be read.
absl::StatusOr<bool> NoteOldRows(StoredFiles* files) {
  bool all_rows_are_read = true;
  for (int64_t after = 0;;) {
    PLEAT_ASSIGN_OR_RETURN(std::vector<CatalogEntry> entries,
                           files->store().catalog().ListUnnotedJobs(after, kNotedTogether));
    if (entries.empty()) return all_rows_are_read;
    after = entries.back().position;
    std::vector<CatalogEntry> noted;
    for (CatalogEntry& entry : entries) {
      if (const absl::Status status = NoteState(&entry); status.ok()) {
        noted.push_back(std::move(entry));
      } else {
        files->ReportBadRow(EntryKind::kJob, entry.id, status);
        all_rows_are_read = false;
      }
    }
    PLEAT_RETURN_IF_ERROR(files->store().catalog().PutAll(EntryKind::kJob, noted));
  }
}

}  // namespace

CatalogEntry JobEntry(const JobInfo& info, int attempts) {
  CatalogEntry entry{.id = info.id, .record = EncodeRecord(info), .attempts = attempts};
  entry.project = info.project;
  entry.job = {.state = JobStateName(info.state),
               .ended_unix_ms = info.ended ? absl::ToUnixMillis(*info.ended) : 0,
               .request_id = info.request_id};
  return entry;
}

absl::Status JobRows::Save(const JobInfo& info, int attempts) {
  PLEAT_RETURN_IF_ERROR(files_->store().catalog().Put(EntryKind::kJob, JobEntry(info, attempts)));
  if (IsFinal(info.state)) RemoveCheckpoints(files_->store(), info.project, info.id);
  if (on_state_) on_state_(info);
  return absl::OkStatus();
}

absl::Status JobRows::Erase(const JobInfo& info) {
  const absl::Status status =
      files_->store().catalog().Delete({EntryKind::kJob, info.project}, info.id);
  return absl::IsNotFound(status) ? absl::OkStatus() : status;
}

absl::StatusOr<StoredJob> JobRows::Read(const std::string& project, const std::string& id) {
  PLEAT_ASSIGN_OR_RETURN(const CatalogEntry entry,
                         files_->store().catalog().Get({EntryKind::kJob, project}, id));
  return StoredJobOf(entry);
}

absl::StatusOr<StoredJob> JobRows::FindRequest(const std::string& project,
                                               const std::string& request_id) {
  PLEAT_ASSIGN_OR_RETURN(const CatalogEntry entry,
                         files_->store().catalog().FindJobOfRequest(project, request_id));
  absl::StatusOr<StoredJob> job = StoredJobOf(entry);
  if (job.ok()) return job;
  // What cannot be read is left out here as in the lists.
  files_->ReportBadRow(EntryKind::kJob, entry.id, job.status());
  return absl::NotFoundError("the job of the request cannot be read");
}

absl::StatusOr<UnfinishedJobs> ReadUnfinishedJobs(StoredFiles* files) {
  UnfinishedJobs unfinished;
  PLEAT_ASSIGN_OR_RETURN(unfinished.all_rows_are_read, NoteOldRows(files));
  PLEAT_ASSIGN_OR_RETURN(const std::vector<CatalogEntry> entries,
                         files->store().catalog().ListUnfinishedJobs());
  for (const CatalogEntry& entry : entries) {
    absl::StatusOr<StoredJob> job = StoredJobOf(entry);
    if (job.ok()) {
      unfinished.jobs.push_back(*std::move(job));
    } else {
      files->ReportBadRow(EntryKind::kJob, entry.id, job.status());
      unfinished.all_rows_are_read = false;
    }
  }
  return unfinished;
}

}  // namespace pleat
