// A stored file that is open for reading.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "absl/status/statusor.h"

namespace pleat {

// Holds its own handle of the file, so that it can be read to its end when the file is deleted or
// moved to the quarantine. Its content never changes. Thread-safe.
class OpenFile {
 public:
  // path: of the file `id`; errors name the id alone. kNotFound when it is not there.
  static absl::StatusOr<std::unique_ptr<OpenFile>> Open(const std::string& path,
                                                        const std::string& id);
  ~OpenFile();
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  uint64_t size_bytes() const { return size_bytes_; }
  // `count` bytes from `offset`, fewer at the end, not verified. kOutOfRange when `offset` is
  // behind the end.
  absl::StatusOr<std::string> Read(uint64_t offset, uint64_t count) const;

 private:
  OpenFile(std::string id, int fd, uint64_t size_bytes);

  const std::string id_;
  const int fd_;
  const uint64_t size_bytes_;
};

}  // namespace pleat
