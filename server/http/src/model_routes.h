// What a page does with a trained model beyond the RPCs: its weights, motions of it, and the edited
// animation in the formats of other programs.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "pleat/base/memory_budget.h"
#include "pleat/grpc/call_gateway.h"
#include "pleat/grpc/grpc_server.h"
#include "pleat/http/http_message.h"
#include "pleat/mesh/mesh_limits.h"
#include "request_target.h"
#include "upload_folders.h"

namespace pleat {

struct ModelRoutes {
  CallGateway* gateway = nullptr;
  // GrpcServer::Admit.
  std::function<absl::StatusOr<AdmittedServices>(const ForeignCaller& caller, const char* rpc)>
      admit;
  UploadFolders* uploads = nullptr;
  MemoryBudget* memory = nullptr;  // may be null
  MeshLimits limits{};

  // GET  /studio/models/ID/rig                      the rig as JSON (docs/formats/rig.md)
  // GET  /studio/models/ID/page                     the character for the shader of the page
  //                                                 (docs/formats/page_character.md)
  // POST /studio/models/ID/motion?sequence=ID       the motion of a stored take, fitted as training
  //                                                 does; or ?upload=ID, of a file that was sent
  // POST /studio/models/ID/export?format=glb&save=N the frames of the motion in the body
  HttpResponse Answer(const RequestTarget& target, const HttpRequest& request) const;
};

}  // namespace pleat
