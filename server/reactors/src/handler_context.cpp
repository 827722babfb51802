#include "pleat/reactors/handler_context.h"

#include "absl/strings/str_cat.h"

namespace pleat {

absl::Status StreamSlot::status() const {
  if (context_->draining) return absl::UnavailableError("the server is shutting down");
  if (granted_) return absl::OkStatus();
  return absl::ResourceExhaustedError(absl::StrCat("more than ", context_->max_open_streams,
                                                   " streams are open (--max-open-streams); close "
                                                   "one or try again later"));
}

}  // namespace pleat
