#include "sync_hook_vfs.h"

#include <cstddef>
#include <cstdint>
#include <new>
#include <utility>

#include "absl/strings/str_cat.h"

namespace pleat {

struct SyncHookVfs::Extra {
  sqlite3_io_methods methods;  // the default ones, but for xSync
  const sqlite3_io_methods* default_methods;
  const SyncHookVfs* owner;
  const char* path;  // SQLite keeps it until the file is closed; null for a temporary file
};

SyncHookVfs::SyncHookVfs(SyncHook hook)
    : hook_(std::move(hook)),
      name_(absl::StrCat("pleat-sync-hook-", reinterpret_cast<uintptr_t>(this))),
      default_vfs_(sqlite3_vfs_find(nullptr)),
      vfs_(*default_vfs_) {
  constexpr int kAlignment = alignof(Extra);
  vfs_.szOsFile = (default_vfs_->szOsFile + kAlignment - 1) / kAlignment * kAlignment +
                  static_cast<int>(sizeof(Extra));
  vfs_.zName = name_.c_str();
  vfs_.pAppData = this;
  vfs_.pNext = nullptr;
  vfs_.xOpen = &OpenFile;
  sqlite3_vfs_register(&vfs_, /*makeDflt=*/0);
}

SyncHookVfs::~SyncHookVfs() { sqlite3_vfs_unregister(&vfs_); }

SyncHookVfs::Extra* SyncHookVfs::ExtraOf(sqlite3_file* file) {
  constexpr int kAlignment = alignof(Extra);
  const int offset =
      (sqlite3_vfs_find(nullptr)->szOsFile + kAlignment - 1) / kAlignment * kAlignment;
  return reinterpret_cast<Extra*>(reinterpret_cast<std::byte*>(file) + offset);
}

int SyncHookVfs::OpenFile(sqlite3_vfs* vfs, const char* path, sqlite3_file* file, int flags,
                          int* out_flags) {
  const auto* self = static_cast<const SyncHookVfs*>(vfs->pAppData);
  const int code = self->default_vfs_->xOpen(self->default_vfs_, path, file, flags, out_flags);
  if (file->pMethods == nullptr) return code;
  auto* extra = new (ExtraOf(file)) Extra{*file->pMethods, file->pMethods, self, path};
  extra->methods.xSync = &SyncDatabaseFile;
  file->pMethods = &extra->methods;
  return code;
}

int SyncHookVfs::SyncDatabaseFile(sqlite3_file* file, int flags) {
  const Extra* extra = ExtraOf(file);
  extra->owner->hook_(extra->path == nullptr ? std::string() : std::string(extra->path));
  return extra->default_methods->xSync(file, flags);
}

}  // namespace pleat
