// What Pleat's own binary files share: magic and version in front and, in a sealed file, a SHA-256
// of everything before it at the end.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "pleat/base/bytes.h"

namespace pleat {

struct FileKind {
  std::string_view magic;   // 8 bytes
  uint32_t version;         // the one that is written
  uint32_t oldest_version;  // the first one that is still read
  const char* name;         // for messages: "sequence file"
};

// Writes magic and version; the writer goes on with the content.
void WriteFileKind(const FileKind& kind, ByteWriter* writer);
// Reads what WriteFileKind wrote and returns the version. kInvalidArgument: another kind of file,
// or a version that is not read.
absl::StatusOr<uint32_t> ReadFileKind(const FileKind& kind, ByteReader* reader);

inline constexpr size_t kFileKindBytes = 12;  // magic and version

// Appends the checksum and returns the whole file.
std::string SealFile(ByteWriter* writer);

struct SealedFile {
  uint32_t version = 0;
  // A view of the file without its checksum: kFileKindBytes of magic and version, then the content.
  std::string_view bytes;
};
// Checks kind, version and checksum. kDataLoss when the checksum does not fit.
absl::StatusOr<SealedFile> OpenSealedFile(const FileKind& kind, std::string_view bytes);

}  // namespace pleat
