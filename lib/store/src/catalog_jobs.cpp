// What the catalog knows of jobs without reading their records. Each statement names the condition
// of the index that it needs in the index's own words, as SQLite asks for
// (sqlite.org/partialindex.html).
#include <string>
#include <vector>

#include "catalog_rows.h"
#include "database.h"
#include "pleat/base/status.h"
#include "pleat/store/catalog.h"

namespace pleat {

absl::StatusOr<std::vector<CatalogEntry>> Catalog::ListUnfinishedJobs() {
  std::lock_guard lock(reader_->mutex());
  Statement statement(
      reader_.get(),
      Select("WHERE kind = 'job' AND job_state IN ('queued', 'running') ORDER BY position")
          .c_str());
  return ReadEntries(&statement);
}

absl::StatusOr<std::vector<CatalogEntry>> Catalog::ListUnnotedJobs(int64_t after_position,
                                                                   int max_entries) {
  std::lock_guard lock(reader_->mutex());
  Statement statement(
      reader_.get(),
      Select("WHERE kind = 'job' AND job_state = '' AND position > ?1 ORDER BY position LIMIT ?2")
          .c_str());
  statement.Bind(1, after_position);
  statement.Bind(2, max_entries);
  return ReadEntries(&statement);
}

absl::StatusOr<std::vector<CatalogEntry>> Catalog::ListEndedJobs(const std::string& project,
                                                                 int64_t from_unix_ms,
                                                                 int64_t before_unix_ms,
                                                                 int max_entries) {
  std::lock_guard lock(reader_->mutex());
  Statement statement(reader_.get(), Select("WHERE kind = 'job' AND project = ?1"
                                            " AND job_state IN ('succeeded', 'failed', 'cancelled')"
                                            " AND ended_ms >= ?2 AND ended_ms < ?3"
                                            " ORDER BY ended_ms, position LIMIT ?4")
                                         .c_str());
  statement.Bind(1, project);
  statement.Bind(2, from_unix_ms);
  statement.Bind(3, before_unix_ms);
  statement.Bind(4, max_entries);
  return ReadEntries(&statement);
}

absl::StatusOr<CatalogEntry> Catalog::FindJobOfRequest(const std::string& project,
                                                       const std::string& request_id) {
  std::lock_guard lock(reader_->mutex());
  Statement statement(reader_.get(),
                      Select("WHERE kind = 'job' AND project = ?1 AND request_id = ?2"
                             " AND request_id <> '' ORDER BY position DESC LIMIT 1")
                          .c_str());
  statement.Bind(1, project);
  statement.Bind(2, request_id);
  PLEAT_ASSIGN_OR_RETURN(std::vector<CatalogEntry> found, ReadEntries(&statement));
  if (found.empty()) return absl::NotFoundError("the request has made no job");
  return std::move(found[0]);
}

absl::StatusOr<std::vector<Catalog::JobCount>> Catalog::CountJobs() {
  std::lock_guard lock(reader_->mutex());
  Statement statement(reader_.get(),
                      "SELECT project, state, num FROM job_counts ORDER BY project, state");
  std::vector<JobCount> counts;
  while (true) {
    PLEAT_ASSIGN_OR_RETURN(const bool found, statement.Step("read"));
    if (!found) return counts;
    counts.push_back({statement.Bytes(0), statement.Bytes(1), statement.Int64(2)});
  }
}

}  // namespace pleat
