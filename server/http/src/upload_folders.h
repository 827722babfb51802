// Files that a browser sends before they are read together: a take may be a folder.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "absl/status/statusor.h"
#include "pleat/http/http_message.h"

namespace pleat {

struct UploadFolderLimits {
  int max_folders = 16;
  int max_files = 20'000;                  // of one folder
  uint64_t max_bytes = uint64_t{4} << 30;  // of all folders together
  double idle_seconds = 600;               // a folder that nobody touches goes away
};

// Thread-safe. What is below `root` when it is made is removed, and all of it at the end.
class UploadFolders {
 public:
  // clock: seconds, monotonic.
  UploadFolders(std::string root, UploadFolderLimits limits, std::function<double()> clock);
  ~UploadFolders();

  // Makes a folder for `owner`, who alone can use it, and returns its id. kResourceExhausted when
  // there are too many.
  absl::StatusOr<std::string> Begin(const std::string& owner);
  // Where a file of the folder goes. kNotFound without the folder, kInvalidArgument for a name that
  // is none (CheckRelativePath), kResourceExhausted above a limit, also while it arrives.
  absl::StatusOr<std::shared_ptr<BodySink>> AddFile(const std::string& owner, const std::string& id,
                                                    const std::string& relative_path);
  // The path of the folder, which stays until the next call that names it, and how large it is.
  struct Folder {
    std::string path;
    uint64_t bytes = 0;
    int num_files = 0;
  };
  absl::StatusOr<Folder> Find(const std::string& owner, const std::string& id);
  void Remove(const std::string& owner, const std::string& id);

 private:
  class File;
  struct Entry {
    std::string owner;
    Folder folder;
    double touched = 0;
  };
  absl::StatusOr<Entry*> FindLocked(const std::string& owner, const std::string& id);
  void RemoveIdleLocked();
  absl::Status Charge(const std::string& id, uint64_t bytes);

  const std::string root_;
  const UploadFolderLimits limits_;
  const std::function<double()> clock_;
  std::mutex mutex_;
  std::map<std::string, Entry> entries_;  // by id; guarded by mutex_
  uint64_t bytes_ = 0;                    // of all; guarded by mutex_
};

// What ReadSequence is given for a folder of files that were dropped on a page: the only cache or
// archive among them, the only file, or else the folder that holds the frames.
absl::StatusOr<std::string> ChooseInput(const std::string& folder);

}  // namespace pleat
