#include "pleat/service/list_page.h"

#include "absl/strings/str_cat.h"
#include "pleat/service/limits.h"

namespace pleat {

absl::StatusOr<int> MaxItemsOf(const PageRequest& request) {
  if (request.size < 0 || request.size > kMaxPageSize) {
    return absl::InvalidArgumentError(
        absl::StrCat("page_size is ", request.size, ", allowed are 0 to ", kMaxPageSize));
  }
  return request.size == 0 ? static_cast<int>(kMaxPageSize) : request.size;
}

}  // namespace pleat
