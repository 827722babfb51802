#include "pleat/base/status.h"
#include "pleat/handlers/unary_handlers.h"
#include "pleat/wire/service_messages.h"

namespace pleat {

absl::Status ListSequences(HandlerContext& context, const v1::ListSequencesRequest& request,
                           v1::ListSequencesResponse* response) {
  PLEAT_ASSIGN_OR_RETURN(const Page<SequenceInfo> page,
                         context.sequences->ListPage({request.page_size(), request.page_token()}));
  for (const SequenceInfo& info : page.items) *response->add_sequences() = ToProto(info);
  response->set_next_page_token(page.next_token);
  return absl::OkStatus();
}

}  // namespace pleat
