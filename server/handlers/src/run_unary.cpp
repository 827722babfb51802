#include "run_unary.h"

#include <grpcpp/server_context.h>
#include <spdlog/spdlog.h>

#include <exception>
#include <new>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "grpc_status.h"

namespace pleat {

absl::Status CallGuarded(const std::function<absl::Status()>& handler) {
  try {
    return handler();
  } catch (const std::bad_alloc&) {
    return absl::ResourceExhaustedError("the server has not enough memory for this call");
  } catch (const std::exception& error) {
    return absl::InternalError(absl::StrCat("unexpected exception: ", error.what()));
  }
}

void LogFailure(const char* rpc, const absl::Status& status) {
  if (status.ok()) return;
  const bool ours = status.code() == absl::StatusCode::kInternal ||
                    status.code() == absl::StatusCode::kUnknown ||
                    status.code() == absl::StatusCode::kDataLoss;
  spdlog::log(ours ? spdlog::level::err : spdlog::level::info, "{} failed: {}", rpc,
              status.ToString());
}

grpc::ServerUnaryReactor* RunUnary(grpc::CallbackServerContext* context, Executor* executor,
                                   const char* rpc, std::function<absl::Status()> handler) {
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  executor->Post([context, reactor, rpc, handler = std::move(handler)] {
    const absl::Status status =
        context->IsCancelled() ? absl::CancelledError("the client gave up") : CallGuarded(handler);
    LogFailure(rpc, status);
    reactor->Finish(ToGrpcStatus(status));
  });
  return reactor;
}

}  // namespace pleat
