#include "pleat/reactors/run_unary.h"

#include <grpcpp/server_context.h>
#include <spdlog/spdlog.h>

#include <cstdint>
#include <exception>
#include <functional>
#include <new>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "pleat/reactors/grpc_status.h"

namespace pleat {
namespace {

class UnaryReactor final : public grpc::ServerUnaryReactor {
 public:
  explicit UnaryReactor(HandlerContext* context) : counter_(context) {}
  void OnDone() override { delete this; }

 private:
  CallCounter counter_;
};

}  // namespace

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

grpc::ServerUnaryReactor* RunUnary(HandlerContext* context, grpc::CallbackServerContext* call,
                                   Executor* executor, const char* rpc,
                                   std::function<absl::Status()> handler) {
  auto* reactor = new UnaryReactor(context);
  const uint64_t flow = std::hash<std::string>()(call->peer()) | 1;  // one per connection
  const auto run = [context, call, reactor, rpc, handler = std::move(handler)] {
    absl::Status status;
    if (context->draining) {
      status = absl::UnavailableError("the server is shutting down");
    } else if (call->IsCancelled()) {
      status = absl::CancelledError("the client gave up");
    } else {
      status = CallGuarded(handler);
    }
    LogFailure(rpc, status);
    reactor->Finish(ToGrpcStatus(status));
  };
  executor->Post(run, flow);
  return reactor;
}

}  // namespace pleat
