// ZIP archives, as far as NumPy's .npz needs them: stored and deflated members, also beyond 4 GiB.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace pleat {

struct ZipMember {
  std::string name{};
  uint64_t compressed_bytes = 0, bytes = 0;
  uint64_t header = 0;  // where its local header begins in the file
  uint32_t crc = 0;
  uint16_t method = 0;  // 0 stored, 8 deflated
  bool is_encrypted = false;
};

// The members of an archive. Its bytes must outlive it.
class ZipArchive {
 public:
  // Reads the list at the end of the file. kInvalidArgument when the bytes are no ZIP archive,
  // kDataLoss when they are cut off or an entry reaches beyond them.
  static absl::StatusOr<ZipArchive> Open(std::string_view bytes);

  const std::vector<ZipMember>& members() const { return members_; }
  // The member of that name, the last where there are several, or null.
  const ZipMember* Find(std::string_view name) const;

  // The bytes of a member: a view of the archive when it is stored, else of `inflated`. Its size
  // and its checksum are those of the list. kResourceExhausted when it is larger than `max_bytes`
  // or could not have come from so few compressed bytes; nothing is allocated before.
  absl::StatusOr<std::string_view> Read(const ZipMember& member, uint64_t max_bytes,
                                        std::string* inflated) const;
  // At most the first `num_bytes` of a member, whose checksum is not looked at. Empty when it
  // cannot be read.
  std::string Start(const ZipMember& member, uint64_t num_bytes) const;

 private:
  absl::Status ReadList(uint64_t begin, uint64_t size, uint64_t num_members);
  // Where the data of a member are.
  absl::StatusOr<std::string_view> DataOf(const ZipMember& member) const;

  std::string_view bytes_;
  std::vector<ZipMember> members_;
};

struct ZipWriterOptions {
  bool deflates = false;
  // Sizes and places from here on are written with 64 bits.
  uint64_t wide_from = 0xffffffff;
};

class ZipWriter {
 public:
  explicit ZipWriter(ZipWriterOptions options = {}) : options_(options) {}

  // Makes room for an archive of that many bytes.
  void Reserve(size_t num_bytes) { bytes_.reserve(num_bytes); }
  // Members need names that differ. The parts are its bytes, one after the other.
  void Add(const std::string& name, std::span<const std::string_view> parts);
  void Add(const std::string& name, std::string_view bytes) { Add(name, std::span(&bytes, 1)); }
  std::string Finish();

 private:
  ZipWriterOptions options_;
  std::string bytes_;
  std::vector<ZipMember> members_;
};

}  // namespace pleat
