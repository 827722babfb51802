// Lists that come in pages.
#pragma once

#include "pleat/base/status.h"

namespace pleat {

// All pages of a list. Response: has next_page_token; `take` moves its items out.
template <typename Request, typename Response, typename Call, typename Take>
absl::Status ReadPages(Call call, Take take) {
  Request request;
  do {
    Response response;
    PLEAT_RETURN_IF_ERROR(call(request, &response));
    PLEAT_RETURN_IF_ERROR(take(response));
    if (response.next_page_token() == request.page_token()) break;  // a server that repeats itself
    request.set_page_token(response.next_page_token());
  } while (!request.page_token().empty());
  return absl::OkStatus();
}

}  // namespace pleat
