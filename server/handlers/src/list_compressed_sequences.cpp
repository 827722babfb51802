#include "pleat/base/status.h"
#include "pleat/handlers/unary_handlers.h"
#include "pleat/wire/service_messages.h"

namespace pleat {

absl::Status ListCompressedSequences(HandlerContext& context,
                                     const v1::ListCompressedSequencesRequest& request,
                                     v1::ListCompressedSequencesResponse* response) {
  PLEAT_ASSIGN_OR_RETURN(
      const Page<CompressedSequenceInfo> page,
      context.compressed_sequences->ListPage({request.page_size(), request.page_token()}));
  for (const CompressedSequenceInfo& info : page.items)
    *response->add_compressed_sequences() = ToProto(info);
  response->set_next_page_token(page.next_token);
  return absl::OkStatus();
}

}  // namespace pleat
