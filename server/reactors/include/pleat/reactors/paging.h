// The pages of a list. The token of a page is the id of the last item before it.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/str_cat.h"
#include "pleat/service/limits.h"

namespace pleat {

// The items [begin, end) are the page that `page_size` and `page_token` ask for; the size 0 asks
// for as many as allowed. kInvalidArgument for a size out of range or a token that names no item
// (any more).
struct PageRange {
  size_t begin = 0, end = 0;
};
template <typename Info>
absl::StatusOr<PageRange> FindPage(const std::vector<Info>& infos, int page_size,
                                   const std::string& page_token) {
  if (page_size < 0 || page_size > kMaxPageSize) {
    return absl::InvalidArgumentError(
        absl::StrCat("page_size is ", page_size, ", allowed are 0 to ", kMaxPageSize));
  }
  PageRange range;
  if (!page_token.empty()) {
    const auto last = std::find_if(infos.begin(), infos.end(),
                                   [&](const Info& info) { return info.id == page_token; });
    if (last == infos.end()) {
      return absl::InvalidArgumentError("page_token names no item any more; start again");
    }
    range.begin = static_cast<size_t>(last - infos.begin()) + 1;
  }
  const size_t count = page_size == 0 ? kMaxPageSize : static_cast<size_t>(page_size);
  range.end = std::min(infos.size(), range.begin + count);
  return range;
}

}  // namespace pleat
