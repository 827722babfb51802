// fsync of files and folders.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "pleat/store/sync_hook.h"

namespace pleat {

// Returns when the content of the open file `fd` survives a power cut. `path` is for the hook.
absl::Status SyncFile(int fd, const std::string& path, const SyncHook& hook);

// Returns when the names in the folder `path` survive a power cut: a rename or a new file is
// durable only then.
absl::Status SyncFolder(const std::string& path, const SyncHook& hook);

}  // namespace pleat
