#include "catalog_schema.h"

#include "absl/strings/str_cat.h"
#include "pleat/base/random_id.h"

namespace pleat {
namespace {

// Version 1 had no tables but `entries`. Version 2 had neither the indexes nor the times of
// `entries`. Version 3 knew no projects: (kind, id) alone was unique, which SQLite can only change
// by making the table anew.
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

// From version 3 on. The order of rows, their positions and the next position stay.
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

}  // namespace

std::string SchemaUpgrade(int version) {
  return absl::StrCat("BEGIN;", version < 3 ? kSchemaOf3 : "", kSchemaOf4,
                      "INSERT OR IGNORE INTO properties VALUES ('secret', '", RandomHexId(8),
                      "'); PRAGMA user_version=", kCatalogVersion, "; COMMIT");
}

}  // namespace pleat
