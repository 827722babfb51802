// Compressed sequences that a service keeps and decodes.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "pleat/base/progress.h"
#include "pleat/mesh/mesh_sequence.h"
#include "pleat/sequence_codec/compress_sequence.h"
#include "pleat/service/content_download.h"
#include "pleat/service/content_upload.h"
#include "pleat/service/entry_life.h"
#include "pleat/service/list_page.h"

namespace pleat {

// What was measured when a sequence was compressed.
struct CompressionRecord {
  std::string sequence_id;  // what was compressed
  CompressOptions options;
  CompressSummary summary;
  double encode_seconds = 0;  // with the check of the promise
  double decode_seconds = 0;  // opening the file and decoding all frames, on one thread
};

struct CompressedSequenceInfo {
  std::string id;  // hex SHA-256 of the file (docs/formats/compressed_sequence.md)
  std::string name;
  int num_frames = 0, num_vertices = 0, num_faces = 0;
  FrameRate frame_rate;
  uint64_t size_bytes = 0;
  std::optional<CompressionRecord> record;  // none of files that were uploaded
  EntryLife life{};
};

// Frames [begin, end) of a sequence; end 0: to its end.
struct FrameRange {
  int begin = 0, end = 0;
};

// What decoding gives, in this order; an error from either ends it.
struct DecodedFramesSink {
  // The first frame of the range: connectivity, appearance, name, frame rate.
  std::function<absl::Status(const MeshSequence& shape)> on_shape;
  // Every frame of the range. positions: 3 x V, meters.
  std::function<absl::Status(int t, const Eigen::Matrix3Xf& positions)> on_frame;
};

// The frames of a range, one after the other, as fast as the caller takes them. Not for two threads
// at once.
class DecodeSession {
 public:
  virtual ~DecodeSession() = default;
  // The first frame of the range with connectivity, appearance, name and frame rate. Call it once,
  // before Next.
  virtual absl::StatusOr<MeshSequence> Shape() = 0;
  // The next frame (3 x V, meters), valid until the next call; null at the end of the range.
  virtual absl::StatusOr<const Eigen::Matrix3Xf*> Next() = 0;
};

using CompressedSequenceUpload = ContentUpload<CompressedSequenceInfo>;

// Thread-safe. kNotFound for an id that the service does not have.
class CompressedSequenceService {
 public:
  virtual ~CompressedSequenceService() = default;

  // file: the bytes of a .plt. Uploading the same content twice gives the same id and stores it
  // once; a record that a job has made stays. ttl: how long the service keeps it at least, above 0.
  virtual absl::StatusOr<CompressedSequenceInfo> Upload(const std::string& file,
                                                        const Progress& progress,
                                                        absl::Duration ttl) = 0;
  absl::StatusOr<CompressedSequenceInfo> Upload(const std::string& file, const Progress& progress) {
    return Upload(file, progress, kKeepForEver);
  }
  virtual absl::StatusOr<CompressedSequenceInfo> Get(const std::string& id) = 0;
  // Oldest first. kInvalidArgument for a size out of range, or a token that this list did not give.
  virtual absl::StatusOr<Page<CompressedSequenceInfo>> ListPage(const PageRequest& request) = 0;
  // All pages together.
  absl::StatusOr<std::vector<CompressedSequenceInfo>> List() {
    return ReadAllPages<CompressedSequenceInfo>(
        [this](const PageRequest& request) { return ListPage(request); });
  }
  virtual absl::Status Delete(const std::string& id) = 0;
  // A pinned one is never removed by retention, only by Delete.
  virtual absl::Status SetPinned(const std::string& id, bool pinned) = 0;
  // The whole file.
  virtual absl::StatusOr<std::string> Download(const std::string& id, const Progress& progress) = 0;
  // The file in pieces, from `offset_bytes` on. kOutOfRange when that is behind its end, kDataLoss
  // when the file has changed.
  virtual absl::StatusOr<std::unique_ptr<ContentDownload>> OpenDownload(const std::string& id,
                                                                        uint64_t offset_bytes) = 0;
  // As SequenceService::BeginUpload, which also tells what has arrived.
  virtual absl::StatusOr<std::unique_ptr<CompressedSequenceUpload>> BeginUpload(
      const std::string& id, uint64_t size_bytes, uint64_t offset_bytes, absl::Duration ttl) = 0;
  absl::StatusOr<std::unique_ptr<CompressedSequenceUpload>> BeginUpload(const std::string& id,
                                                                        uint64_t size_bytes,
                                                                        uint64_t offset_bytes) {
    return BeginUpload(id, size_bytes, offset_bytes, kKeepForEver);
  }
  // kInvalidArgument when the range is not inside the sequence, kResourceExhausted when all
  // decoders together would take more memory than the service allows.
  virtual absl::StatusOr<std::unique_ptr<DecodeSession>> OpenDecode(const std::string& id,
                                                                    FrameRange range) = 0;
};

// Gives the shape and all frames of a session that has begun at frame range.begin to `sink`.
absl::Status DecodeInto(DecodeSession& session, FrameRange range, const DecodedFramesSink& sink);

// The same for a stored sequence.
absl::Status DecodeFrames(CompressedSequenceService& compressed, const std::string& id,
                          FrameRange range, const DecodedFramesSink& sink);

}  // namespace pleat
