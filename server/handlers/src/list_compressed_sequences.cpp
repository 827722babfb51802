#include "pleat/base/status.h"
#include "pleat/handlers/unary_handlers.h"
#include "pleat/reactors/paging.h"
#include "pleat/wire/service_messages.h"

namespace pleat {

absl::Status ListCompressedSequences(HandlerContext& context,
                                     const v1::ListCompressedSequencesRequest& request,
                                     v1::ListCompressedSequencesResponse* response) {
  PLEAT_ASSIGN_OR_RETURN(const std::vector<CompressedSequenceInfo> infos,
                         context.compressed_sequences->List());
  PLEAT_ASSIGN_OR_RETURN(const PageRange page,
                         FindPage(infos, request.page_size(), request.page_token()));
  for (size_t i = page.begin; i < page.end; ++i) {
    *response->add_compressed_sequences() = ToProto(infos[i]);
  }
  if (page.end < infos.size() && page.end > 0) {
    response->set_next_page_token(infos[page.end - 1].id);
  }
  return absl::OkStatus();
}

}  // namespace pleat
