// A file that leaves a service in pieces.
#pragma once

#include <cstdint>
#include <string>

#include "absl/status/statusor.h"

namespace pleat {

// The bytes of one file from where the download was opened to the end. Once it is open it goes to
// its end, whatever is deleted meanwhile. Not for two threads at once.
class ContentDownload {
 public:
  virtual ~ContentDownload() = default;

  virtual uint64_t size_bytes() const = 0;  // of the whole file
  // The next bytes, at most kDownloadPieceBytes; empty at the end of the file. kDataLoss when the
  // file ends before its size.
  virtual absl::StatusOr<std::string> Next() = 0;
};

}  // namespace pleat
