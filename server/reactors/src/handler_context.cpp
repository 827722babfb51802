#include "pleat/reactors/handler_context.h"

#include "absl/strings/str_cat.h"
#include "pleat/base/limit_refusal.h"

namespace pleat {
namespace {

// Streams end when their clients want; most are short.
constexpr absl::Duration kRetryOpening = absl::Seconds(2);

}  // namespace

absl::Status StreamSlot::status() const {
  if (calls_->draining) return absl::UnavailableError("the server is shutting down");
  if (granted_) return memory_.status();
  return RefuseForLimit({.limit = "--max-open-streams", .retry_after = kRetryOpening},
                        absl::StrCat("more than ", calls_->max_open_streams,
                                     " streams are open (--max-open-streams); close one or try "
                                     "again later"));
}

}  // namespace pleat
