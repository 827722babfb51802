#include "ogawa_reader.h"

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

constexpr std::string_view kOgawaMagic = "Ogawa";
constexpr size_t kOgawaHeaderBytes = 16;
constexpr char kFrozen = '\xff';

uint64_t NumberAt(std::string_view bytes, uint64_t position) {
  uint64_t number;
  std::memcpy(&number, bytes.data() + position, sizeof(number));
  return number;
}

}  // namespace

absl::StatusOr<OgawaReader> OgawaReader::Open(std::string_view bytes) {
  if (!bytes.starts_with(kOgawaMagic)) {
    return absl::InvalidArgumentError("not an Alembic archive: it does not begin with 'Ogawa'");
  }
  if (bytes.size() < kOgawaHeaderBytes) {
    return absl::DataLossError(absl::StrCat("the archive has ", bytes.size(),
                                            " bytes, less than its header of ", kOgawaHeaderBytes,
                                            "; it is cut off"));
  }
  const int version = static_cast<unsigned char>(bytes[6]) * 256 + bytes[7];
  if (version != 1) {
    return absl::InvalidArgumentError(
        absl::StrCat("version ", version, " of the Ogawa container, only 1 is known"));
  }
  if (bytes[5] != kFrozen) {
    return absl::InvalidArgumentError(
        "the archive was never closed: its writer crashed or still writes; export it again");
  }
  return OgawaReader(bytes, OgawaRef{NumberAt(bytes, 8)});
}

absl::StatusOr<std::string_view> OgawaReader::Counted(OgawaRef ref, uint64_t item_bytes) const {
  const uint64_t position = ref.position();
  if (position == 0) return std::string_view();
  if (position < kOgawaHeaderBytes || position > bytes_.size() ||
      bytes_.size() - position < sizeof(uint64_t)) {
    return absl::DataLossError(absl::StrCat("a reference leads to byte ", position, " of ",
                                            bytes_.size(), "; the file is cut off or damaged"));
  }
  const uint64_t count = NumberAt(bytes_, position);
  const uint64_t there = bytes_.size() - position - sizeof(uint64_t);
  if (count > there / item_bytes) {
    return absl::DataLossError(absl::StrCat(ref.is_data() ? "data" : "a group", " at byte ",
                                            position, " declares ", count,
                                            ref.is_data() ? " bytes" : " children", " but ", there,
                                            " bytes follow; the file is cut ", "off or damaged"));
  }
  return bytes_.substr(position + sizeof(uint64_t), count * item_bytes);
}

absl::StatusOr<OgawaGroup> OgawaReader::Group(OgawaRef ref) const {
  if (ref.is_data()) {
    return absl::DataLossError(
        absl::StrCat("data at byte ", ref.position(), " where a group should be"));
  }
  PLEAT_ASSIGN_OR_RETURN(const std::string_view references, Counted(ref, sizeof(uint64_t)));
  return OgawaGroup(references);
}

absl::StatusOr<std::string_view> OgawaReader::Data(OgawaRef ref) const {
  if (!ref.is_data()) {
    return absl::DataLossError(
        absl::StrCat("a group at byte ", ref.position(), " where data should be"));
  }
  return Counted(ref, 1);
}

}  // namespace pleat
