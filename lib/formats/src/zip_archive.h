// ZIP archives, as far as NumPy's .npz needs them: stored and deflated members, also beyond 4 GiB.
#pragma once

#include <cstdint>
#include <deque>
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

  // Members need names that differ. The parts are its bytes, one after the other; stored ones are
  // not copied and must outlive the writer.
  void Add(const std::string& name, std::span<const std::string_view> parts);
  void Add(const std::string& name, std::string bytes);
  std::string Finish();
  // The archive in parts, which live as long as this object and what was added.
  std::vector<std::string_view> FinishParts();

 private:
  void Append(std::string bytes);  // which are kept here

  ZipWriterOptions options_;
  std::deque<std::string> kept_;
  std::vector<std::string_view> parts_;
  uint64_t num_bytes_ = 0;
  std::vector<ZipMember> members_;
};

}  // namespace pleat
