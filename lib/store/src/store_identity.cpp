#include "store_identity.h"

#include <algorithm>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "pleat/base/file.h"
#include "pleat/base/random_id.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

constexpr int kStoreIdLength = 32;
constexpr uint64_t kMaxIdFileBytes = 256;

constexpr char kWhatToDo[] =
    "; nothing was changed. Restore the side that is wrong from a backup, or run 'pleat store "
    "repair', which makes the rows anew from the files";

std::string IdPath(const std::string& blobs_folder) { return blobs_folder + "/STORE"; }

}  // namespace

absl::StatusOr<std::string> AgreeOnStoreId(const StoreSides& sides, const std::string& data_dir) {
  const auto refuse = [&](const std::string& why) {
    return absl::FailedPreconditionError(
        absl::StrCat("the data folder '", data_dir, "' does not fit together: ", why, kWhatToDo));
  };
  if (!sides.catalog_id.empty() && !sides.blobs_id.empty()) {
    if (sides.catalog_id == sides.blobs_id) return sides.catalog_id;
    return refuse(absl::StrCat("the catalog belongs to the store ", sides.catalog_id,
                               " and the files belong to the store ", sides.blobs_id));
  }
  const std::string& known = sides.catalog_id.empty() ? sides.blobs_id : sides.catalog_id;
  const bool is_empty = sides.num_named == 0 && sides.num_files == 0;
  if (is_empty || sides.num_common > 0) return known;
  if (sides.num_named == 0) {
    return refuse(absl::StrCat("the catalog is empty, and the files beside it are ",
                               sides.num_files, " (was catalogue.db removed?)"));
  }
  if (sides.num_files == 0) {
    return refuse(absl::StrCat("the catalog names ", sides.num_named,
                               " files, and none of them is there (is a disk not mounted?)"));
  }
  return refuse(absl::StrCat("the catalog names ", sides.num_named,
                             " files and none of them is "
                             "among the ",
                             sides.num_files, " that are there"));
}

std::string MakeStoreId() { return RandomHexId(kStoreIdLength / 8); }

absl::StatusOr<std::string> ReadBlobsId(const std::string& blobs_folder) {
  const absl::StatusOr<std::string> text = ReadFile(IdPath(blobs_folder), kMaxIdFileBytes);
  if (absl::IsNotFound(text.status())) return std::string();
  PLEAT_RETURN_IF_ERROR(text.status());
  const std::string id(absl::StripAsciiWhitespace(*text));
  const bool is_id =
      id.size() == size_t{kStoreIdLength} &&
      std::ranges::all_of(id, [](unsigned char c) { return absl::ascii_isxdigit(c); });
  if (is_id) return id;
  return absl::DataLossError(absl::StrCat("'", IdPath(blobs_folder), "' is damaged", kWhatToDo));
}

absl::Status WriteBlobsId(const std::string& blobs_folder, const std::string& id) {
  return WriteFile(IdPath(blobs_folder), id + "\n");
}

}  // namespace pleat
