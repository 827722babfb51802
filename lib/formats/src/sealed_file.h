// What Pleat's own files share: magic and version in front, a checksum at the end.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "pleat/base/bytes.h"

namespace pleat {

struct SealedFileKind {
  std::string_view magic;   // 8 bytes
  uint32_t version;         // that is written
  uint32_t oldest_version;  // that is still read
  const char* name;         // for messages: "sequence file"
};

// Magic and version; the writer goes on with the content.
void BeginSealedFile(const SealedFileKind& kind, ByteWriter* writer);
// Appends the checksum and returns the whole file.
std::string SealFile(ByteWriter* writer);

// Checks magic, version and checksum. Returns the file without its checksum, of which the first
// kSealedHeaderBytes are magic and version.
absl::StatusOr<std::string_view> OpenSealedFile(const SealedFileKind& kind, std::string_view bytes);

inline constexpr size_t kSealedHeaderBytes = 12;

// Of what OpenSealedFile returned.
uint32_t SealedFileVersion(std::string_view content);

}  // namespace pleat
