// Mesh sequences that a service keeps.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "pleat/base/progress.h"
#include "pleat/mesh/mesh_sequence.h"
#include "pleat/service/content_download.h"
#include "pleat/service/content_upload.h"
#include "pleat/service/entry_life.h"
#include "pleat/service/list_page.h"

namespace pleat {

struct SequenceInfo {
  std::string id;  // hex SHA-256 of the sequence file's bytes (docs/formats/sequence_file.md)
  std::string name;
  int num_frames = 0, num_vertices = 0, num_faces = 0;
  FrameRate frame_rate;
  uint64_t size_bytes = 0;
  EntryLife life{};
};

using SequenceUpload = ContentUpload<SequenceInfo>;

// Thread-safe. kNotFound for an id that the service does not have.
class SequenceService {
 public:
  virtual ~SequenceService() = default;

  // Uploading the same content twice gives the same id and stores it once. ttl: how long the
  // service keeps it at least, above 0.
  virtual absl::StatusOr<SequenceInfo> Upload(const MeshSequence& sequence,
                                              const Progress& progress, absl::Duration ttl) = 0;
  absl::StatusOr<SequenceInfo> Upload(const MeshSequence& sequence, const Progress& progress) {
    return Upload(sequence, progress, kKeepForEver);
  }
  virtual absl::StatusOr<SequenceInfo> Get(const std::string& id) = 0;
  // Oldest first. kInvalidArgument for a size out of range, or a token that this list did not give.
  virtual absl::StatusOr<Page<SequenceInfo>> ListPage(const PageRequest& request) = 0;
  // All pages together.
  absl::StatusOr<std::vector<SequenceInfo>> List() {
    return ReadAllPages<SequenceInfo>(
        [this](const PageRequest& request) { return ListPage(request); });
  }
  virtual absl::Status Delete(const std::string& id) = 0;
  // A pinned one is never removed by retention, only by Delete.
  virtual absl::Status SetPinned(const std::string& id, bool pinned) = 0;

  // The sequence file in pieces, from `offset_bytes` on. kOutOfRange when that is behind its end,
  // kDataLoss when the file has changed.
  virtual absl::StatusOr<std::unique_ptr<ContentDownload>> OpenDownload(const std::string& id,
                                                                        uint64_t offset_bytes) = 0;

  // What has arrived of the file `id`, sequence or compressed sequence: where to go on.
  virtual absl::StatusOr<UploadStatus> QueryUpload(const std::string& id) = 0;
  // Goes on with the sequence file `id`, `size_bytes` in all, at `offset_bytes`; 0 starts again.
  // kAborted when another writer holds it, kOutOfRange when `offset_bytes` is not what has arrived,
  // kResourceExhausted when it is above a limit or the disk is full.
  virtual absl::StatusOr<std::unique_ptr<SequenceUpload>> BeginUpload(const std::string& id,
                                                                      uint64_t size_bytes,
                                                                      uint64_t offset_bytes,
                                                                      absl::Duration ttl) = 0;
  absl::StatusOr<std::unique_ptr<SequenceUpload>> BeginUpload(const std::string& id,
                                                              uint64_t size_bytes,
                                                              uint64_t offset_bytes) {
    return BeginUpload(id, size_bytes, offset_bytes, kKeepForEver);
  }
  // Forgets what has arrived of the file `id`, sequence or compressed sequence. kNotFound when
  // nothing has, kAborted while a writer holds it.
  virtual absl::Status DeleteUpload(const std::string& id) = 0;
};

}  // namespace pleat
