// The data folder of one server.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/store/blob_store.h"
#include "pleat/store/catalogue.h"
#include "pleat/store/upload_area.h"

namespace pleat {

struct StoreOptions {
  std::string data_dir{};
  uint64_t reserve_bytes = uint64_t{256} << 20;  // kept free on the disk
};

// Holds the folder for this process alone; all parts are thread-safe.
class Store {
 public:
  // Makes the folder when it is missing and removes what a crash left behind (files without row).
  // kFailedPrecondition when another process holds it.
  static absl::StatusOr<std::unique_ptr<Store>> Open(const StoreOptions& options);
  ~Store();
  Store(const Store&) = delete;
  Store& operator=(const Store&) = delete;

  BlobStore& blobs() { return *blobs_; }
  Catalogue& catalogue() { return *catalogue_; }
  UploadArea& uploads() { return *uploads_; }

  // Ids of sequences, models and rigs whose file was gone when the store was opened.
  const std::vector<std::string>& missing_files() const { return missing_files_; }

 private:
  Store() = default;
  absl::Status Clean();

  int lock_fd_ = -1;
  std::unique_ptr<BlobStore> blobs_;
  std::unique_ptr<Catalogue> catalogue_;
  std::unique_ptr<UploadArea> uploads_;
  std::vector<std::string> missing_files_;
};

}  // namespace pleat
