// The gRPC services: each method hands over to its handler.
#pragma once

#include <grpcpp/impl/service_type.h>

#include <memory>
#include <vector>

#include "pleat/reactors/handler_context.h"

namespace pleat {

std::unique_ptr<grpc::Service> MakeSequenceService(HandlerContext* context);
std::unique_ptr<grpc::Service> MakeJobService(HandlerContext* context);
std::unique_ptr<grpc::Service> MakeModelService(HandlerContext* context);
std::unique_ptr<grpc::Service> MakeCompressedSequenceService(HandlerContext* context);
std::unique_ptr<grpc::Service> MakePoseService(HandlerContext* context);

}  // namespace pleat
