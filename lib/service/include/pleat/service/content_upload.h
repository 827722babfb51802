// An upload that arrives in pieces.
#pragma once

#include <cstdint>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace pleat {

// What the service has of a file that is being uploaded.
struct UploadStatus {
  uint64_t received_bytes = 0;
  bool complete = false;  // the file is stored
};

// The right of one writer to add to one upload. Destroying it keeps what has arrived, so that a
// later writer can go on. Not for two threads at once.
template <typename Info>
class ContentUpload {
 public:
  virtual ~ContentUpload() = default;

  // True: the service has the whole file already. Then nothing needs to be appended, nobody looks
  // at what is, and Finish says what the service knows.
  virtual bool complete() const { return false; }
  // kOutOfRange when more than the declared size would arrive.
  virtual absl::Status Append(std::string_view bytes) = 0;
  virtual uint64_t received_bytes() const = 0;
  // Checks the complete file and stores it, which takes seconds for large ones. Call it once, last.
  // kFailedPrecondition when bytes are missing, kDataLoss when they are not those that the id
  // names, kInvalidArgument or kResourceExhausted when they are no such file or above a limit.
  virtual absl::StatusOr<Info> Finish() = 0;
};

}  // namespace pleat
