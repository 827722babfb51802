// SQLite's own file layer with a SyncHook before every sync.
#pragma once

#include <sqlite3.h>

#include <string>

#include "pleat/store/sync_hook.h"

namespace pleat {

// Registers the layer under a name of its own, for sqlite3_open_v2, and removes it at the end of
// its life; connections that use it must be closed before.
//
// It is the default layer with two changes. xOpen gives every file a copy of the default table of
// methods in which xSync is ours, and that copy stands behind the default layer's file (szOsFile is
// larger by it). Everything else (locks, shared memory, reads, writes) goes straight to the default
// layer, which sees the files that it opened itself.
class SyncHookVfs {
 public:
  explicit SyncHookVfs(SyncHook hook);
  ~SyncHookVfs();
  SyncHookVfs(const SyncHookVfs&) = delete;
  SyncHookVfs& operator=(const SyncHookVfs&) = delete;

  const char* name() const { return name_.c_str(); }

 private:
  struct Extra;  // what stands behind the default layer's file
  static Extra* ExtraOf(sqlite3_file* file);
  static int OpenFile(sqlite3_vfs* vfs, const char* path, sqlite3_file* file, int flags,
                      int* out_flags);
  static int SyncDatabaseFile(sqlite3_file* file, int flags);

  const SyncHook hook_;
  const std::string name_;
  sqlite3_vfs* const default_vfs_;
  sqlite3_vfs vfs_;
};

}  // namespace pleat
