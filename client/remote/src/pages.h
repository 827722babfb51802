// Reads lists that come in pages.
#pragma once

#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "pleat/base/status.h"
#include "pleat/wire/service_messages.h"

namespace pleat {

// Returns all items of a list. call: asks for one page. messages_of: returns the items of a page,
// each of which FromProto turns into an Info.
template <typename Info, typename Request, typename Response, typename Call, typename MessagesOf>
absl::StatusOr<std::vector<Info>> ReadPages(Call call, MessagesOf messages_of) {
  std::vector<Info> infos;
  Request request;
  do {
    Response response;
    PLEAT_RETURN_IF_ERROR(call(request, &response));
    for (const auto& message : messages_of(response)) {
      PLEAT_ASSIGN_OR_RETURN(Info info, FromProto(message));
      infos.push_back(std::move(info));
    }
    if (response.next_page_token() == request.page_token()) break;  // or it would never end
    request.set_page_token(response.next_page_token());
  } while (!request.page_token().empty());
  return infos;
}

}  // namespace pleat
