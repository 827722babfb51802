#include "pleat/base/content_id.h"
#include "pleat/base/status.h"
#include "pleat/handlers/unary_handlers.h"
#include "pleat/wire/service_messages.h"

namespace pleat {

absl::Status GetCompressedSequence(HandlerContext& context,
                                   const v1::GetCompressedSequenceRequest& request,
                                   v1::GetCompressedSequenceResponse* response) {
  PLEAT_RETURN_IF_ERROR(CheckContentId(request.id(), "id"));
  PLEAT_ASSIGN_OR_RETURN(const CompressedSequenceInfo info,
                         context.compressed_sequences->Get(request.id()));
  *response->mutable_compressed_sequence() = ToProto(info);
  return absl::OkStatus();
}

}  // namespace pleat
