// What exists, as rows of a SQLite database.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "pleat/base/project.h"
#include "pleat/store/sync_hook.h"

namespace pleat {

class Database;
class SyncHookVfs;

enum class EntryKind { kSequence, kModel, kCompressedSequence, kJob, kRig, kCheckpoint };
inline constexpr EntryKind kEntryKinds[] = {
    EntryKind::kSequence, EntryKind::kModel, EntryKind::kCompressedSequence,
    EntryKind::kJob,      EntryKind::kRig,   EntryKind::kCheckpoint};
// Those that are a file and a row; jobs are rows alone.
inline constexpr EntryKind kFileKinds[] = {EntryKind::kSequence, EntryKind::kModel,
                                           EntryKind::kCompressedSequence, EntryKind::kRig,
                                           EntryKind::kCheckpoint};
const char* EntryKindName(EntryKind kind);  // "compressed sequence"

// Where the catalog of a data folder is, and the endings of the files that SQLite keeps for it: the
// database comes last.
std::string CatalogPath(const std::string& data_dir);
inline constexpr const char* kCatalogSuffixes[] = {"-wal", "-shm", ""};

// What is asked about jobs without reading their records.
struct JobColumns {
  std::string state{};        // JobStateName; empty: not noted, as in rows of older versions
  int64_t ended_unix_ms = 0;  // 0: has not ended, or not known
  std::string request_id{};   // of the call that made it; empty: none
};

struct CatalogEntry {
  std::string id{};
  std::string record{};         // the owner's own bytes
  int attempts = 0;             // jobs: how often one was started
  int64_t created_unix_ms = 0;  // when it was first added; 0: not known
  int64_t expires_unix_ms = 0;  // when retention may remove it; 0: never
  bool pinned = false;          // retention never removes it; Put neither sets nor clears this
  int64_t position = 0;         // in the order of all entries, from 1; the catalog sets it
  std::string project = kDefaultProject;  // who sees it
  uint64_t file_bytes = 0;                // of its file; jobs have none
  JobColumns job{};
};

// What one project may see of a kind: an entry is found by project, kind and id, so the same
// content in two projects is two entries over one file.
struct ProjectKind {
  EntryKind kind;
  std::string project = kDefaultProject;
  // Implicit: a kind alone is that of the default project.
  ProjectKind(EntryKind of_kind) : kind(of_kind) {}  // NOLINT(google-explicit-constructor)
  ProjectKind(EntryKind of_kind, std::string of_project)
      : kind(of_kind), project(std::move(of_project)) {}
};

// Invariants:
//  - The file is a SQLite database in write-ahead-log mode; its version is PRAGMA user_version. The
//    rows of the table `entries` are what exists; `record` is opaque here, records.h says what it
//    holds. `properties` holds the id of the store, `removals` the files that are to be removed.
//  - An entry is (project, kind, id). Its position, the order in which entries were added, never
//    changes.
//  - `projects` holds the sum of the file sizes of each project, and `job_counts` the number of its
//    jobs by state, in the same commit as the entries.
//  - A call that changes something returns after its commit has been synced (synchronous=FULL):
//    what was reported survives a power cut. A crash before that loses the whole change, never a
//    part.
//  - Nobody sees a change before it is durable: SQLite publishes a commit to readers after the
//    sync.
//
// Threads: two connections, each behind its own mutex. All changes go through `writer_`, one at a
// time, because SQLite has one writer anyway and two connections that write would starve each
// other; its mutex is held during the sync. All reads go through `reader_`, which sees the last
// commit and in write-ahead-log mode waits for no writer. So a read never waits for a sync, and a
// thread that reads after its own write returned sees that write. Neither mutex is held while the
// other is taken. Thread-safe.
class Catalog {
 public:
  // Makes the file when it is missing. kFailedPrecondition when a newer version wrote it or when it
  // cannot be written, kDataLoss when it is damaged.
  static absl::StatusOr<std::unique_ptr<Catalog>> Open(const std::string& path,
                                                       SyncHook before_sync = {});
  // Opens a file that must exist, also while another process uses it. Calls that change something
  // fail.
  static absl::StatusOr<std::unique_ptr<Catalog>> OpenReadOnly(const std::string& path);
  ~Catalog();
  Catalog(const Catalog&) = delete;
  Catalog& operator=(const Catalog&) = delete;

  // Adds the entry or replaces the one with the same id. That one keeps its place in the order, its
  // time of creation, and the longer of the two lives.
  absl::Status Put(EntryKind kind, const CatalogEntry& entry);
  // The same for many, in one commit: all of them or none.
  absl::Status PutAll(EntryKind kind, const std::vector<CatalogEntry>& entries);
  // kNotFound, in the same words, for an id that nobody has and for one of another project.
  absl::StatusOr<CatalogEntry> Get(const ProjectKind& kind, const std::string& id);
  // The oldest file of this kind and id in any project; kNotFound.
  absl::StatusOr<CatalogEntry> GetInAnyProject(EntryKind kind, const std::string& id);
  absl::StatusOr<std::vector<CatalogEntry>> List(EntryKind kind);  // of all projects, oldest first
  // The `max_entries` oldest entries behind `after_position`, which 0 puts before all. The cost
  // depends on their number alone, and not on what else the catalog holds.
  absl::StatusOr<std::vector<CatalogEntry>> ListPage(const ProjectKind& kind,
                                                     int64_t after_position, int max_entries);
  // The file sizes of a project together, at constant cost.
  absl::StatusOr<uint64_t> ProjectBytes(const std::string& project);
  // The same for every project that ever had an entry, by name.
  absl::StatusOr<std::vector<std::pair<std::string, uint64_t>>> ListProjectBytes();
  // Notes the size of a file whose entries do not know it: rows of older versions.
  absl::Status NoteFileSize(const std::string& id, uint64_t file_bytes);
  // The ids of files whose size is not noted.
  absl::StatusOr<std::vector<std::string>> FilesWithoutSize();

  // Jobs (catalog_jobs.cpp). What each of these costs depends on what it returns, and not on how
  // many jobs have ended.
  //
  // Those of all projects that wait or run, oldest first.
  absl::StatusOr<std::vector<CatalogEntry>> ListUnfinishedJobs();
  // The oldest ones of all projects behind `after_position` whose state is not noted.
  absl::StatusOr<std::vector<CatalogEntry>> ListUnnotedJobs(int64_t after_position,
                                                            int max_entries);
  // The ones of a project that ended first, from one time on and before another; those that do not
  // know when they ended stand at time 0.
  absl::StatusOr<std::vector<CatalogEntry>> ListEndedJobs(const std::string& project,
                                                          int64_t from_unix_ms,
                                                          int64_t before_unix_ms, int max_entries);
  // The newest job that a request of the project made; kNotFound.
  absl::StatusOr<CatalogEntry> FindJobOfRequest(const std::string& project,
                                                const std::string& request_id);
  struct JobCount {
    std::string project, state;
    int64_t num = 0;
  };
  absl::StatusOr<std::vector<JobCount>> CountJobs();  // by project and state; some may be 0

  // The steps that SQLite's machine has taken for all reads so far.
  uint64_t num_read_steps() const;
  // kNotFound when there is none. In the same commit the file of the entry becomes a pending
  // removal.
  absl::Status Delete(const ProjectKind& kind, const std::string& id);
  // Deletes every entry that names the file `id`; OK when there is none.
  absl::Status DeleteInAllProjects(const std::string& id);

  // The three below are kNotFound when there is no such entry.
  absl::Status SetPinned(const ProjectKind& kind, const std::string& id, bool pinned);
  // The longer of the two lives counts. expires_unix_ms: 0 = never.
  absl::Status Prolong(const ProjectKind& kind, const std::string& id, int64_t expires_unix_ms);
  // Deletes the entry if it is not pinned and its life was over at `now_unix_ms`.
  absl::Status DeleteExpired(const ProjectKind& kind, const std::string& id, int64_t now_unix_ms);
  // The entries of all projects that DeleteExpired would delete, oldest first. The cost depends on
  // their number.
  absl::StatusOr<std::vector<CatalogEntry>> ListExpired(EntryKind kind, int64_t now_unix_ms);

  // The content ids that the rows name, sorted.
  absl::StatusOr<std::vector<std::string>> FileIds();
  // Says whether any row names the file `id`.
  absl::StatusOr<bool> NamesFile(const std::string& id);

  // Files whose last row was deleted and which may still be on the disk. Adding an entry takes its
  // id off the list.
  absl::StatusOr<std::vector<std::string>> PendingRemovals();
  absl::Status ForgetRemoval(const std::string& id);  // does not wait for the disk

  // The id of the store that the rows belong to (StoreIdentity); empty when it was never set.
  absl::StatusOr<std::string> StoreId();
  absl::Status SetStoreId(const std::string& id);

  // A random text that only this catalog knows, made by its first use of this version.
  absl::StatusOr<std::string> Secret();

  // Writes what the catalog holds at this moment to a new database at `path`.
  absl::Status CopyTo(const std::string& path);

 private:
  Catalog();
  absl::Status Upgrade(int version);  // brings the file to the version of this program
  // Looks for damage and returns the version, 0 for an empty file.
  absl::StatusOr<int> CheckFile(const std::string& path);
  absl::StatusOr<std::vector<std::string>> Ids(const char* sql);
  absl::Status PutRow(EntryKind kind, const CatalogEntry& entry);  // with the writer's mutex held
  // Selects the rows of entries that `conditions`, the rest of the statement, is about.
  std::string Select(const char* conditions) const;
  // Runs a statement that changes the entry with `?1 = kind AND ?2 = id AND ?4 = project`;
  // kNotFound when it changes none. `value`: ?3.
  absl::Status Change(const char* sql, const ProjectKind& kind, const std::string& id,
                      std::optional<int64_t> value = std::nullopt);

  std::unique_ptr<SyncHookVfs> vfs_;  // null without a hook; outlives the connections
  std::unique_ptr<Database> writer_;
  std::unique_ptr<Database> reader_;
  // What the file has that older versions had not; false only when it was opened read-only.
  bool has_properties_ = true;
  bool has_lives_ = true;
  bool has_projects_ = true;
  bool has_job_columns_ = true;
};

}  // namespace pleat
