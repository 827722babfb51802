// Uploads that have not ended: they survive broken connections and restarts.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "pleat/store/disk_space.h"
#include "pleat/store/staged_file.h"
#include "pleat/store/sync_hook.h"

namespace pleat {

class UploadArea;

// The right of one writer to add to one upload. Destroying it keeps what has arrived.
class Upload {
 public:
  ~Upload();
  Upload(const Upload&) = delete;
  Upload& operator=(const Upload&) = delete;

  const std::string& id() const { return id_; }
  uint64_t received_bytes() const { return received_bytes_; }
  uint64_t size_bytes() const { return size_bytes_; }

  // kOutOfRange when more than the declared size would arrive.
  absl::Status Append(std::string_view bytes);
  // The complete content, verified. kFailedPrecondition when bytes are missing; kDataLoss when
  // they do not have the declared SHA-256: then the upload starts again at 0.
  absl::StatusOr<std::string> ReadComplete();
  // The complete upload, synced, for BlobStore::Publish; call after ReadComplete. Syncing takes
  // long for a large upload: call it without holding a lock.
  absl::StatusOr<StagedFile> Stage();
  // Forgets what has arrived.
  void Discard();

 private:
  friend class UploadArea;
  Upload(UploadArea* area, std::string id, std::string path, uint64_t size_bytes, int fd,
         uint64_t received_bytes, SpaceReservation room);

  SpaceReservation room_;  // for the bytes that are still to come
  UploadArea* area_;
  std::string id_, path_;
  uint64_t size_bytes_ = 0, received_bytes_ = 0;
  int fd_ = -1;
};

// Invariants:
//  - FOLDER/ab12....part holds a prefix of the content whose SHA-256 is ab12..., as far as its
//    sender tells the truth; ReadComplete finds out.
//  - Its length is the offset at which the upload goes on. Nothing else is remembered, so a restart
//    loses nothing but what the operating system had not written when the power failed: then the
//    sender is told a smaller offset.
//  - An upload has at most one writer (active_), and only this writer truncates, moves or removes
//    the file.
//
// Thread-safe.
class UploadArea {
 public:
  // Uses (and makes) `folder`.
  static absl::StatusOr<std::unique_ptr<UploadArea>> Open(std::string folder,
                                                          SyncHook before_sync = {});

  // Bytes of the upload `id` that have arrived, 0 when there is none.
  uint64_t ReceivedBytes(const std::string& id) const;

  // Goes on with the upload `id` of `size_bytes` in all at `offset_bytes`. kAborted when another
  // writer holds it, kOutOfRange (naming the right offset) when `offset_bytes` is not what has
  // arrived; offset 0 starts again. `room` is held for what is still to come.
  absl::StatusOr<std::unique_ptr<Upload>> Begin(const std::string& id, uint64_t size_bytes,
                                                uint64_t offset_bytes, SpaceReservation room = {});

  // All bytes that have arrived for uploads that have not ended.
  uint64_t TotalBytes() const;

  // Forgets what has arrived of an upload. kNotFound when nothing has, kAborted while a writer
  // holds it.
  absl::Status Remove(const std::string& id);
  // Forgets the uploads that no writer holds and that got their last byte before `time`. Returns
  // their ids, sorted.
  std::vector<std::string> RemoveUntouchedSince(absl::Time time);

 private:
  friend class Upload;
  UploadArea(std::string folder, SyncHook before_sync)
      : folder_(std::move(folder)), before_sync_(std::move(before_sync)) {}
  std::string PathOf(const std::string& id) const { return folder_ + "/" + id + ".part"; }
  void Release(const std::string& id);

  const std::string folder_;
  const SyncHook before_sync_;
  std::mutex mutex_;
  std::set<std::string> active_;  // guarded by mutex_
};

}  // namespace pleat
