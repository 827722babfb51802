// Compressed sequences in the store of this process.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "pleat/base/memory_budget.h"
#include "pleat/local/project_quota.h"
#include "pleat/local/stored_files.h"
#include "pleat/sequence_codec/sequence_decoder.h"
#include "pleat/service/compressed_sequence_service.h"

namespace pleat {

// Thread-safe. `files` must outlive it.
class LocalCompressedSequences final : public CompressedSequenceService {
 public:
  // memory: of all decoders together; it must outlive the sessions. frames: what decoding is
  // charged to; null: nothing.
  LocalCompressedSequences(StoredFiles* files, MemoryBudget* memory, ProjectQuota* frames = nullptr)
      : files_(files), memory_(memory), frames_(frames) {}

  using CompressedSequenceService::BeginUpload;
  using CompressedSequenceService::Upload;
  absl::StatusOr<CompressedSequenceInfo> Upload(const std::string& file, const Progress& progress,
                                                absl::Duration ttl) override;
  absl::StatusOr<CompressedSequenceInfo> Get(const std::string& id) override;
  absl::StatusOr<Page<CompressedSequenceInfo>> ListPage(const PageRequest& request) override;
  absl::Status Delete(const std::string& id) override;
  absl::Status SetPinned(const std::string& id, bool pinned) override;
  absl::StatusOr<std::string> Download(const std::string& id, const Progress& progress) override;
  absl::StatusOr<std::unique_ptr<ContentDownload>> OpenDownload(const std::string& id,
                                                                uint64_t offset_bytes) override;
  absl::StatusOr<std::unique_ptr<CompressedSequenceUpload>> BeginUpload(
      const std::string& id, uint64_t size_bytes, uint64_t offset_bytes,
      absl::Duration ttl) override;
  absl::StatusOr<std::unique_ptr<DecodeSession>> OpenDecode(const std::string& id,
                                                            FrameRange range) override;

  // The memory that is reserved for decoders now.
  uint64_t decoder_bytes() const { return memory_->used_bytes(); }

 private:
  absl::StatusOr<SequenceDecoder> OpenDecoder(std::string bytes) const;
  absl::StatusOr<CompressedSequenceInfo> FinishUpload(pleat::Upload* upload, absl::Duration ttl);

  StoredFiles* const files_;
  MemoryBudget* const memory_;
  ProjectQuota* const frames_;
};

}  // namespace pleat
