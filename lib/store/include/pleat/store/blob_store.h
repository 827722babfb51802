// Immutable files named by the SHA-256 of their content.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace pleat {

// Thread-safe: files appear by rename and never change.
class BlobStore {
 public:
  // Uses (and makes) `folder`. Writes that would leave less than `reserve_bytes` on the disk are
  // refused with kResourceExhausted: on a full disk not even deleting from the catalogue works.
  static absl::StatusOr<BlobStore> Open(std::string folder, uint64_t reserve_bytes);

  // Stores `bytes` durably and returns their id. Storing the same content again is a no-op.
  absl::StatusOr<std::string> Put(std::string_view bytes);
  // Takes over the complete file `path` (same disk), whose content the caller has checked to be
  // `id`.
  absl::Status Adopt(const std::string& path, const std::string& id);

  // The content, verified: kNotFound, or kDataLoss when the disk gave other bytes.
  absl::StatusOr<std::string> Get(const std::string& id) const;
  // `count` bytes from `offset` (fewer at the end), not verified.
  absl::StatusOr<std::string> GetRange(const std::string& id, uint64_t offset,
                                       uint64_t count) const;
  absl::StatusOr<uint64_t> Size(const std::string& id) const;
  bool Contains(const std::string& id) const;
  absl::Status Delete(const std::string& id);             // OK when it is not there
  absl::StatusOr<std::vector<std::string>> List() const;  // all ids, sorted

  // kResourceExhausted when `bytes` more would touch the reserve.
  absl::Status CheckSpace(uint64_t bytes) const;

 private:
  BlobStore(std::string folder, uint64_t reserve_bytes)
      : folder_(std::move(folder)), reserve_bytes_(reserve_bytes) {}
  std::string PathOf(const std::string& id) const;

  std::string folder_;
  uint64_t reserve_bytes_;
};

}  // namespace pleat
