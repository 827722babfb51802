// The moments at which bytes become durable, made visible.
#pragma once

#include <functional>
#include <string>

namespace pleat {

// Called with the path of a file or folder right before it is synced, on the thread that waits for
// the disk. A test records the order of the syncs, or blocks one of them to prove what goes on
// meanwhile; a server leaves it empty. Thread-safe.
using SyncHook = std::function<void(const std::string& path)>;

}  // namespace pleat
