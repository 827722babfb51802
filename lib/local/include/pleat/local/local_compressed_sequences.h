// Compressed sequences in the store of this process.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "pleat/base/memory_budget.h"
#include "pleat/local/stored_files.h"
#include "pleat/sequence_codec/sequence_decoder.h"
#include "pleat/service/compressed_sequence_service.h"

namespace pleat {

// Thread-safe. `files` must outlive it, and it must outlive the sessions that it opens.
class LocalCompressedSequences final : public CompressedSequenceService {
 public:
  // decode_bytes: the memory that all decoders together may take.
  LocalCompressedSequences(StoredFiles* files, uint64_t decode_bytes)
      : files_(files),
        decode_bytes_(decode_bytes),
        decode_memory_(decode_bytes, "--decode-bytes") {}

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
  uint64_t decoder_bytes() const { return decode_memory_.used_bytes(); }

 private:
  absl::StatusOr<SequenceDecoder> OpenDecoder(std::string bytes) const;
  absl::StatusOr<CompressedSequenceInfo> FinishUpload(pleat::Upload* upload, absl::Duration ttl);

  StoredFiles* const files_;
  const uint64_t decode_bytes_;
  MemoryBudget decode_memory_;
};

}  // namespace pleat
