// Reads lists that come in pages.
#pragma once

#include <utility>

#include "absl/status/statusor.h"
#include "pleat/base/status.h"
#include "pleat/service/list_page.h"
#include "pleat/wire/service_messages.h"

namespace pleat {

// Returns one page of a list. call: makes the call. messages_of: returns the items of its answer,
// each of which FromProto turns into an Info.
template <typename Info, typename Request, typename Response, typename Call, typename MessagesOf>
absl::StatusOr<Page<Info>> ReadPage(const PageRequest& page, Call call, MessagesOf messages_of) {
  Request request;
  Response response;
  request.set_page_size(page.size);
  request.set_page_token(page.token);
  PLEAT_RETURN_IF_ERROR(call(request, &response));
  Page<Info> read{.items = {}, .next_token = response.next_page_token()};
  for (const auto& message : messages_of(response)) {
    PLEAT_ASSIGN_OR_RETURN(Info info, FromProto(message));
    read.items.push_back(std::move(info));
  }
  return read;
}

}  // namespace pleat
