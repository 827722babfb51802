#include "pleat/base/status.h"
#include "pleat/handlers/unary_handlers.h"
#include "pleat/reactors/paging.h"
#include "pleat/wire/service_messages.h"

namespace pleat {

absl::Status ListModels(HandlerContext& context, const v1::ListModelsRequest& request,
                        v1::ListModelsResponse* response) {
  PLEAT_ASSIGN_OR_RETURN(const std::vector<ModelInfo> infos, context.models->List());
  PLEAT_ASSIGN_OR_RETURN(const PageRange page,
                         FindPage(infos, request.page_size(), request.page_token()));
  for (size_t i = page.begin; i < page.end; ++i) *response->add_models() = ToProto(infos[i]);
  if (page.end < infos.size() && page.end > 0) {
    response->set_next_page_token(infos[page.end - 1].id);
  }
  return absl::OkStatus();
}

}  // namespace pleat
