#include "pleat/base/status.h"
#include "pleat/handlers/unary_handlers.h"
#include "pleat/wire/service_messages.h"

namespace pleat {

absl::Status ListModels(HandlerContext& context, const v1::ListModelsRequest& request,
                        v1::ListModelsResponse* response) {
  PLEAT_ASSIGN_OR_RETURN(const Page<ModelInfo> page,
                         context.models->ListPage({request.page_size(), request.page_token()}));
  for (const ModelInfo& info : page.items) *response->add_models() = ToProto(info);
  response->set_next_page_token(page.next_token);
  return absl::OkStatus();
}

}  // namespace pleat
