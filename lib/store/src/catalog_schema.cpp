#include "catalog_schema.h"

#include "absl/strings/str_cat.h"
#include "pleat/base/random_id.h"

namespace pleat {
namespace {

// Version 1 had no tables but `entries`. Version 2 had neither the indexes nor the times of
// `entries`. Version 3 knew no projects: (kind, id) alone was unique, which SQLite can only change
// by making the table anew. Version 4 knew of jobs only what their records say.
//
// From an empty file, version 1 or version 2 to version 3.
constexpr char kSchemaOf3[] =
    "CREATE TABLE IF NOT EXISTS entries ("
    " position INTEGER PRIMARY KEY AUTOINCREMENT,"
    " kind TEXT NOT NULL,"
    " id TEXT NOT NULL,"
    " record BLOB NOT NULL,"
    " attempts INTEGER NOT NULL DEFAULT 0,"
    " UNIQUE (kind, id));"
    "ALTER TABLE entries ADD COLUMN created_ms INTEGER NOT NULL DEFAULT 0;"
    "ALTER TABLE entries ADD COLUMN expires_ms INTEGER NOT NULL DEFAULT 0;"
    "ALTER TABLE entries ADD COLUMN pinned INTEGER NOT NULL DEFAULT 0;";

// From version 3. The order of rows, their positions and the next position stay.
//
// The triggers keep `removals` and `projects` right whatever changes the rows: an entry that goes
// leaves the id of its file in `removals` in the same commit, and one that comes takes the id back.
constexpr char kSchemaOf4[] =
    "CREATE TABLE IF NOT EXISTS properties (name TEXT PRIMARY KEY, value TEXT NOT NULL);"
    "CREATE TABLE IF NOT EXISTS removals (id TEXT PRIMARY KEY) WITHOUT ROWID;"
    "DROP TRIGGER IF EXISTS entry_removed;"
    "DROP TRIGGER IF EXISTS entry_added;"
    "CREATE TABLE new_entries ("
    " position INTEGER PRIMARY KEY AUTOINCREMENT,"
    " project TEXT NOT NULL,"
    " kind TEXT NOT NULL,"
    " id TEXT NOT NULL,"
    " record BLOB NOT NULL,"
    " attempts INTEGER NOT NULL DEFAULT 0,"
    " created_ms INTEGER NOT NULL DEFAULT 0,"
    " expires_ms INTEGER NOT NULL DEFAULT 0,"
    " pinned INTEGER NOT NULL DEFAULT 0,"
    " file_bytes INTEGER NOT NULL DEFAULT 0,"
    " UNIQUE (project, kind, id));"
    "INSERT INTO new_entries SELECT position, 'default', kind, id, record, attempts, created_ms,"
    " expires_ms, pinned, 0 FROM entries;"
    "DELETE FROM sqlite_sequence WHERE name='new_entries';"
    "INSERT INTO sqlite_sequence SELECT 'new_entries', seq FROM sqlite_sequence"
    " WHERE name='entries';"
    "DROP TABLE entries;"
    "ALTER TABLE new_entries RENAME TO entries;"
    "CREATE INDEX entries_in_order ON entries (project, kind, position);"
    "CREATE INDEX entries_by_id ON entries (id);"
    "CREATE INDEX entries_that_expire ON entries (expires_ms) WHERE expires_ms > 0;"
    "CREATE INDEX entries_without_size ON entries (id) WHERE file_bytes = 0 AND kind <> 'job';"
    "CREATE TABLE projects (name TEXT PRIMARY KEY, file_bytes INTEGER NOT NULL) WITHOUT ROWID;"
    "INSERT INTO projects VALUES ('default', 0);"
    "CREATE TRIGGER entry_removed AFTER DELETE ON entries WHEN OLD.kind <> 'job'"
    " BEGIN INSERT OR IGNORE INTO removals VALUES (OLD.id);"
    " UPDATE projects SET file_bytes = file_bytes - OLD.file_bytes WHERE name = OLD.project; END;"
    "CREATE TRIGGER entry_added AFTER INSERT ON entries"
    " BEGIN DELETE FROM removals WHERE id = NEW.id;"
    " INSERT INTO projects VALUES (NEW.project, NEW.file_bytes)"
    " ON CONFLICT (name) DO UPDATE SET file_bytes = file_bytes + NEW.file_bytes; END;"
    "CREATE TRIGGER entry_sized AFTER UPDATE OF file_bytes ON entries"
    " BEGIN UPDATE projects SET file_bytes = file_bytes + NEW.file_bytes - OLD.file_bytes"
    " WHERE name = NEW.project; END;";

// From version 4. What is asked of jobs without reading them all: those that have not ended, the
// one of a request, those that ended first, and how many there are. Rows of older versions have no
// state until whoever can read their records notes it. The index of files holds no jobs, so that
// looking through all files costs what the files cost.
constexpr char kSchemaOf5[] =
    "ALTER TABLE entries ADD COLUMN job_state TEXT NOT NULL DEFAULT '';"
    "ALTER TABLE entries ADD COLUMN ended_ms INTEGER NOT NULL DEFAULT 0;"
    "ALTER TABLE entries ADD COLUMN request_id TEXT NOT NULL DEFAULT '';"
    "DROP INDEX entries_by_id;"
    "CREATE INDEX files_by_id ON entries (id) WHERE kind <> 'job';"
    "CREATE INDEX files_in_order ON entries (kind, position) WHERE kind <> 'job';"
    "CREATE INDEX jobs_by_state ON entries (job_state, position) WHERE kind = 'job';"
    "CREATE INDEX jobs_by_request ON entries (project, request_id) WHERE request_id <> '';"
    "CREATE INDEX jobs_by_end ON entries (project, ended_ms, position)"
    " WHERE job_state IN ('succeeded', 'failed', 'cancelled');"
    "CREATE TABLE job_counts (project TEXT, state TEXT, num INTEGER NOT NULL,"
    " PRIMARY KEY (project, state)) WITHOUT ROWID;"
    "INSERT INTO job_counts SELECT project, job_state, COUNT(*) FROM entries WHERE kind = 'job'"
    " GROUP BY project, job_state;"
    "CREATE TRIGGER job_added AFTER INSERT ON entries WHEN NEW.kind = 'job'"
    " BEGIN INSERT INTO job_counts VALUES (NEW.project, NEW.job_state, 1)"
    " ON CONFLICT (project, state) DO UPDATE SET num = num + 1; END;"
    "CREATE TRIGGER job_removed AFTER DELETE ON entries WHEN OLD.kind = 'job'"
    " BEGIN UPDATE job_counts SET num = num - 1"
    " WHERE project = OLD.project AND state = OLD.job_state; END;"
    "CREATE TRIGGER job_changed AFTER UPDATE OF job_state ON entries"
    " WHEN NEW.kind = 'job' AND NEW.job_state <> OLD.job_state"
    " BEGIN UPDATE job_counts SET num = num - 1"
    " WHERE project = OLD.project AND state = OLD.job_state;"
    " INSERT INTO job_counts VALUES (NEW.project, NEW.job_state, 1)"
    " ON CONFLICT (project, state) DO UPDATE SET num = num + 1; END;";

}  // namespace

std::string SchemaUpgrade(int version) {
  return absl::StrCat("BEGIN;", version < 3 ? kSchemaOf3 : "", version < 4 ? kSchemaOf4 : "",
                      kSchemaOf5, "INSERT OR IGNORE INTO properties VALUES ('secret', '",
                      RandomHexId(8), "'); PRAGMA user_version=", kCatalogVersion, "; COMMIT");
}

}  // namespace pleat
