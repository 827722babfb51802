#include "pleat/reactors/run_unary.h"

#include <grpcpp/server_context.h>
#include <spdlog/spdlog.h>

#include <atomic>
#include <cstdint>
#include <exception>
#include <functional>
#include <new>
#include <string>
#include <utility>

#include "pleat/reactors/admission.h"
#include "pleat/reactors/call_reactor.h"
#include "pleat/reactors/grpc_status.h"

namespace pleat {
namespace {

class UnaryReactor final : public CallReactor<grpc::ServerUnaryReactor> {
 public:
  UnaryReactor(HandlerContext* context, Executor* executor, uint64_t flow, const char* rpc,
               std::function<absl::Status()> handler)
      : CallReactor(context),
        context_(context),
        executor_(executor),
        flow_(flow),
        rpc_(rpc),
        handler_(std::move(handler)) {}
  void Start() {
    Post(
        executor_, [this] { Run(); }, flow_);
  }
  void OnCancel() override { cancelled_ = true; }

 private:
  void Run() {
    absl::Status status;
    if (context_->draining) {
      status = absl::UnavailableError("the server is shutting down");
    } else if (cancelled_) {
      status = absl::CancelledError("the client gave up");
    } else {
      status = CallGuarded(handler_);
    }
    LogFailure(rpc_, status);
    Finish(ToGrpcStatus(status));
  }

  HandlerContext* const context_;
  Executor* const executor_;
  const uint64_t flow_;
  const char* const rpc_;
  const std::function<absl::Status()> handler_;
  std::atomic<bool> cancelled_ = false;
};

}  // namespace

absl::Status CallGuarded(const std::function<absl::Status()>& handler) {
  try {
    return handler();
  } catch (const std::bad_alloc&) {
    return absl::ResourceExhaustedError("the server has not enough memory for this call");
  } catch (const std::exception& error) {
    spdlog::error("unexpected exception: {}", error.what());  // for operators, not for callers
    return absl::InternalError("a fault of the server; its log says more");
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
  const uint64_t flow = std::hash<std::string>()(call->peer()) | 1;  // one per connection, never 0
  if (absl::Status status = Admit(*context, *call, rpc); !status.ok()) {
    handler = [status = std::move(status)] { return status; };
  }
  return StartReactor<UnaryReactor>(context, executor, flow, rpc, std::move(handler));
}

}  // namespace pleat
