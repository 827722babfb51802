// Immutable files named by the SHA-256 of their content.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "pleat/store/disk_space.h"
#include "pleat/store/open_file.h"
#include "pleat/store/staged_file.h"
#include "pleat/store/sync_hook.h"

namespace pleat {

// Invariants:
//  - The file FOLDER/ab/ab12... holds the bytes whose SHA-256 is ab12..., all of them, from the
//    moment it can be seen. It is never opened for writing, so readers need no lock.
//  - A file appears by rename(2) alone, and its content was synced before. The order is
//        1. write FOLDER/ab/ab12....tmp-XXXXXX     Stage: seconds, without any lock
//        2. fsync of that file                     Stage
//        3. rename to FOLDER/ab/ab12...            Publish: microseconds
//        4. fsync of FOLDER/ab, then of FOLDER     Publish: the name, and the new folder's name
//    A crash before 3 leaves a .tmp- file, which the next Open removes. A crash between 3 and 4 may
//    lose the name or keep it; either way no reader was promised the file, and its content is whole
//    when the name is there. After 4 the file survives a power cut.
//  - Two writers of the same content race harmlessly: each has a temporary file of its own, and the
//    second rename replaces a file by an equal one.
//  - Whether a file should exist is not decided here: the catalog's row says so (Store).
//  - The names of files are content ids and nothing else (IsContentId), so an id from outside can
//    never reach another path.
//
// Thread-safe.
class BlobStore {
 public:
  // Uses (and makes) `folder`. Writes that would leave less than `reserve_bytes` on the disk are
  // refused with kResourceExhausted: on a full disk not even deleting from the catalog works.
  static absl::StatusOr<BlobStore> Open(std::string folder, uint64_t reserve_bytes,
                                        SyncHook before_sync = {});

  // Reads `folder`, which another process may use, and changes nothing in it.
  static BlobStore OpenReadOnly(std::string folder);

  // Writes and syncs `bytes` under a temporary name, unless the content is stored already and is
  // intact and may be kept. This is the slow half of storing a file: call it without holding a
  // lock.
  enum class IfThere { kKeep, kReplace };
  absl::StatusOr<StagedFile> Stage(std::string_view bytes, IfThere if_there = IfThere::kKeep);
  // Gives the file its name, durably. kAborted when it was already stored but has been deleted
  // since; stage it again.
  absl::Status Publish(StagedFile file);
  // Stage and Publish; returns the id. Storing the same content again is a no-op.
  absl::StatusOr<std::string> Put(std::string_view bytes);

  // The content, verified: kNotFound, or kDataLoss when the disk gave other bytes.
  absl::StatusOr<std::string> Get(const std::string& id) const;
  // Reads the whole file and compares its SHA-256, in little memory. OK, or the errors of Get.
  absl::Status Verify(const std::string& id) const;
  // The file for reading in pieces, not verified; kNotFound.
  absl::StatusOr<std::unique_ptr<OpenFile>> OpenForReading(const std::string& id) const;
  absl::StatusOr<uint64_t> Size(const std::string& id) const;
  bool Contains(const std::string& id) const;
  absl::Status Delete(const std::string& id);             // OK when it is not there
  absl::StatusOr<std::vector<std::string>> List() const;  // all ids, sorted

  // Keeps room for `bytes` more. kResourceExhausted when that would touch the reserve.
  absl::StatusOr<SpaceReservation> ReserveSpace(uint64_t bytes) const {
    return space_->Reserve(bytes);
  }

  absl::StatusOr<uint64_t> FreeBytes() const { return space_->FreeBytes(); }

  const std::string& folder() const { return folder_; }
  // Where the file of `id`, which must be a content id, is or would be.
  std::string PathOf(const std::string& id) const;

 private:
  BlobStore(std::string folder, std::shared_ptr<DiskSpace> space, SyncHook before_sync)
      : folder_(std::move(folder)),
        space_(std::move(space)),
        before_sync_(std::move(before_sync)) {}
  std::string FolderOf(const std::string& id) const;

  std::string folder_;
  std::shared_ptr<DiskSpace> space_;
  SyncHook before_sync_;
};

}  // namespace pleat
