// Mesh sequences in the store of this process.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "pleat/local/stored_files.h"
#include "pleat/service/sequence_service.h"

namespace pleat {

// Thread-safe. `files` must outlive it.
class LocalSequences final : public SequenceService {
 public:
  explicit LocalSequences(StoredFiles* files) : files_(files) {}

  using SequenceService::BeginUpload;
  using SequenceService::Upload;
  absl::StatusOr<SequenceInfo> Upload(const MeshSequence& sequence, const Progress& progress,
                                      absl::Duration ttl) override;
  absl::StatusOr<SequenceInfo> Get(const std::string& id) override;
  absl::StatusOr<Page<SequenceInfo>> ListPage(const PageRequest& request) override;
  absl::Status Delete(const std::string& id) override;
  absl::Status SetPinned(const std::string& id, bool pinned) override;
  absl::StatusOr<std::unique_ptr<ContentDownload>> OpenDownload(const std::string& id,
                                                                uint64_t offset_bytes) override;
  absl::StatusOr<UploadStatus> QueryUpload(const std::string& id) override;
  absl::StatusOr<std::unique_ptr<SequenceUpload>> BeginUpload(const std::string& id,
                                                              uint64_t size_bytes,
                                                              uint64_t offset_bytes,
                                                              absl::Duration ttl) override;
  absl::Status DeleteUpload(const std::string& id) override;

  // Reads and decodes the sequence itself, for jobs. kNotFound when there is none.
  absl::StatusOr<MeshSequence> Load(const std::string& id);

 private:
  absl::Status Check(const MeshSequence& sequence) const;
  absl::StatusOr<SequenceInfo> FinishUpload(pleat::Upload* upload, absl::Duration ttl);

  StoredFiles* const files_;
};

}  // namespace pleat
