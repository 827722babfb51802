// The gRPC services. Each of their methods hands its call over to the handler of the same name.
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
