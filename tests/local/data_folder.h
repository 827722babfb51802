// A data folder with what the services of this process need, without workers and threads.
#pragma once

#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "pleat/local/local_sequences.h"
#include "pleat/local/stored_files.h"
#include "pleat/store/store.h"
#include "support/temporary_folder.h"

namespace pleat {

class DataFolder {
 public:
  // Opens the folder, again after the first time.
  void Open(const ServiceLimits& limits = {}) {
    sequences_.reset();
    files_.reset();  // gives the lock of the folder back
    files_ = std::make_unique<StoredFiles>(
        Store::Open({.data_dir = folder_.path(),
                     .reserve_bytes = 0,
                     .on_problem = [this](const std::string& text) { problems_.push_back(text); }})
            .value(),
        limits, [this] { return now_; });
    sequences_ = std::make_unique<LocalSequences>(files_.get());
  }
  // The time of day of the folder, which stands still.
  absl::Time now() const { return now_; }
  void Pass(absl::Duration duration) { now_ += duration; }
  StoredFiles& files() { return *files_; }
  LocalSequences& sequences() { return *sequences_; }
  const std::string& path() const { return folder_.path(); }
  // What the operator was told.
  const std::vector<std::string>& problems() const { return problems_; }
  // Where the content `id` lies.
  std::string PathOf(const std::string& id) const {
    return folder_.path() + "/blobs/" + id.substr(0, 2) + "/" + id;
  }
  // From now on the content `id` cannot be stored: a file is where its folder should be.
  void Block(const std::string& id) {
    const std::filesystem::path folder = std::filesystem::path(PathOf(id)).parent_path();
    std::filesystem::remove_all(folder);
    std::ofstream(folder) << "in the way";
  }
  void Unblock(const std::string& id) {
    std::filesystem::remove(std::filesystem::path(PathOf(id)).parent_path());
  }

 private:
  TemporaryFolder folder_;
  std::vector<std::string> problems_;
  absl::Time now_ = absl::FromUnixSeconds(1'800'000'000);
  std::unique_ptr<StoredFiles> files_;
  std::unique_ptr<LocalSequences> sequences_;
};

}  // namespace pleat
