// Lists come in pages: whoever reads the next page pays for that page alone, however long the list.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/base/status.h"

namespace pleat {

struct PageRequest {
  int size = 0;         // items at most, up to kMaxPageSize; 0: kMaxPageSize
  std::string token{};  // Page::next_token of the page before; empty: the first page
};

template <typename Info>
struct Page {
  std::vector<Info> items;  // may be fewer than the size, and none, before the last page too
  std::string next_token;   // opaque; empty: this was the last page
};

// Returns how many items the page has at most. kInvalidArgument for a size out of range.
absl::StatusOr<int> MaxItemsOf(const PageRequest& request);

// Returns all items of a list: the pages that `read` gives, one after the other. A list that gives
// the same token again ends there, or it would never end.
template <typename Info>
absl::StatusOr<std::vector<Info>> ReadAllPages(
    const std::function<absl::StatusOr<Page<Info>>(const PageRequest&)>& read) {
  std::vector<Info> infos;
  PageRequest request;
  do {
    PLEAT_ASSIGN_OR_RETURN(Page<Info> page, read(request));
    for (Info& info : page.items) infos.push_back(std::move(info));
    if (page.next_token == request.token) break;
    request.token = std::move(page.next_token);
  } while (!request.token.empty());
  return infos;
}

}  // namespace pleat
