#include "pleat/base/bytes.h"

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"

namespace pleat {

absl::Status ByteReader::Require(uint64_t count, uint64_t item_bytes,
                                 absl::string_view what) const {
  // The division keeps a hostile count from overflowing the product.
  if (item_bytes == 0 || count <= remaining() / item_bytes) return absl::OkStatus();
  return absl::DataLossError(absl::StrCat(
      "truncated at byte ", offset_, ": ", what, " needs ", count, " items of ", item_bytes,
      " bytes but ", remaining(), " bytes are left; the file is cut off or corrupt"));
}

absl::StatusOr<std::string_view> ByteReader::ReadRaw(size_t count, absl::string_view what) {
  PLEAT_RETURN_IF_ERROR(Require(count, 1, what));
  std::string_view raw = bytes_.substr(offset_, count);
  offset_ += count;
  return raw;
}

absl::StatusOr<std::string> ByteReader::ReadString(size_t max_bytes, absl::string_view what) {
  PLEAT_ASSIGN_OR_RETURN(const uint32_t length, Read<uint32_t>(what));
  if (length > max_bytes) {
    return absl::DataLossError(absl::StrCat("at byte ", offset_, ": ", what, " declares ", length,
                                            " bytes, the limit is ", max_bytes));
  }
  PLEAT_ASSIGN_OR_RETURN(const std::string_view raw, ReadRaw(length, what));
  return std::string(raw);
}

}  // namespace pleat
