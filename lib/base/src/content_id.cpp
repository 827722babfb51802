#include "pleat/base/content_id.h"

#include <algorithm>

#include "absl/strings/str_cat.h"

namespace pleat {

bool IsContentId(std::string_view id) {
  return id.size() == kContentIdLength && std::all_of(id.begin(), id.end(), [](char c) {
           return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f');
         });
}

absl::Status CheckContentId(std::string_view id, absl::string_view what) {
  if (IsContentId(id)) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat(what, " must be ", kContentIdLength, " lower-case hexadecimal digits"));
}

}  // namespace pleat
