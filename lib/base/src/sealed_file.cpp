#include "pleat/base/sealed_file.h"

#include <algorithm>
#include <cstring>
#include <span>
#include <tuple>

#include "absl/strings/str_cat.h"
#include "pleat/base/sha256.h"
#include "pleat/base/status.h"

namespace pleat {

namespace {
constexpr size_t kChecksumBytes = std::tuple_size_v<Sha256Digest>;
}  // namespace

void WriteFileKind(const FileKind& kind, ByteWriter* writer) {
  writer->WriteRaw(kind.magic);
  writer->Write(kind.version);
}

absl::StatusOr<uint32_t> ReadFileKind(const FileKind& kind, ByteReader* reader) {
  const size_t num_there = std::min(reader->remaining(), kind.magic.size());
  PLEAT_ASSIGN_OR_RETURN(const std::string_view magic, reader->ReadRaw(num_there, "magic"));
  if (magic != kind.magic) {
    return absl::InvalidArgumentError(absl::StrCat(
        "not a Pleat ", kind.name, ": it does not begin with ", std::string(kind.magic)));
  }
  PLEAT_ASSIGN_OR_RETURN(const uint32_t version, reader->Read<uint32_t>("version"));
  if (version < kind.oldest_version || version > kind.version) {
    std::string readable = absl::StrCat("version ", kind.oldest_version);
    if (kind.version > kind.oldest_version) absl::StrAppend(&readable, " to ", kind.version);
    return absl::InvalidArgumentError(
        absl::StrCat(kind.name, " version ", version, "; this program reads ", readable));
  }
  return version;
}

std::string SealFile(ByteWriter* writer) {
  const Sha256Digest digest = ComputeSha256(writer->bytes());
  writer->WriteArray(std::span<const uint8_t>(digest));
  return writer->Release();
}

absl::StatusOr<SealedFile> OpenSealedFile(const FileKind& kind, std::string_view bytes) {
  if (bytes.empty())
    return absl::InvalidArgumentError(absl::StrCat("the ", kind.name, " is empty"));
  ByteReader reader(bytes);
  SealedFile file;
  PLEAT_ASSIGN_OR_RETURN(file.version, ReadFileKind(kind, &reader));
  PLEAT_RETURN_IF_ERROR(reader.Require(kChecksumBytes, 1, "checksum"));
  file.bytes = bytes.substr(0, bytes.size() - kChecksumBytes);
  const Sha256Digest digest = ComputeSha256(file.bytes);
  if (std::memcmp(digest.data(), bytes.data() + file.bytes.size(), kChecksumBytes) != 0) {
    return absl::DataLossError(absl::StrCat("the checksum of the ", kind.name,
                                            " does not fit its content: it is cut off or corrupt"));
  }
  return file;
}

}  // namespace pleat
