#include "pleat/reactors/run_unary.h"

#include <grpcpp/server_context.h>
#include <spdlog/spdlog.h>

#include <atomic>
#include <cstdint>
#include <exception>
#include <new>
#include <string>
#include <utility>

#include "pleat/base/status.h"
#include "pleat/reactors/admission.h"
#include "pleat/reactors/call_reactor.h"
#include "pleat/reactors/grpc_status.h"

namespace pleat {
namespace {

// Messages below this are part of kUnaryCallBytes, and measuring a larger one takes little beside
// reading it. On the wire an empty message inside of another takes two bytes and fifty in memory,
// so only the parsed size counts.
constexpr size_t kSmallMessageBytes = 512;

uint64_t MemoryOf(const google::protobuf::Message* message) {
  if (message == nullptr || message->ByteSizeLong() < kSmallMessageBytes) return 0;
  return message->SpaceUsedLong();
}

class UnaryReactor final : public CallReactor<grpc::ServerUnaryReactor> {
 public:
  // context: that of the project; not OK: why the call is refused.
  UnaryReactor(const UnaryCall& call, absl::StatusOr<HandlerContext*> context, uint64_t flow,
               UnaryHandler handler)
      : CallReactor(call.context),
        calls_(call.context->calls.get()),
        call_(call),
        context_(std::move(context)),
        flow_(flow),
        handler_(std::move(handler)) {}

  void Start() {
    absl::Status status = context_.status();
    if (status.ok()) status = Charge(kUnaryCallBytes + MemoryOf(call_.request));
    if (!status.ok()) return End(status);
    Post(
        call_.executor, [this] { Run(); }, flow_);
  }
  void OnCancel() override { cancelled_ = true; }

 private:
  void Run() {
    absl::Status status;
    if (calls_->draining) {
      status = absl::UnavailableError("the server is shutting down");
    } else if (cancelled_) {
      status = absl::CancelledError("the client gave up");
    } else {
      status = CallGuarded([this] { return handler_(**context_); });
    }
    // A client that does not read leaves its answers here. Small ones are paid for already: so no
    // call that has changed something is refused afterwards.
    const uint64_t answer = status.ok() ? MemoryOf(call_.response) : 0;
    if (answer > kUnaryCallBytes) {
      status = Charge(kUnaryCallBytes + MemoryOf(call_.request) + 2 * answer);
    }
    End(status);
  }

  absl::Status Charge(uint64_t bytes) {
    if (calls_->request_memory == nullptr || bytes == memory_.bytes()) return absl::OkStatus();
    memory_ = Reservation();
    PLEAT_ASSIGN_OR_RETURN(memory_, calls_->request_memory->Reserve(bytes, call_.rpc));
    return absl::OkStatus();
  }

  void End(const absl::Status& status) {
    LogFailure(call_.rpc, status);
    Finish(ToGrpcStatus(status));
  }

  ServerCalls* const calls_;
  const UnaryCall call_;
  const absl::StatusOr<HandlerContext*> context_;
  const uint64_t flow_;
  const UnaryHandler handler_;
  Reservation memory_;
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
              status.ToString(absl::StatusToStringMode::kWithNoExtraData));
}

grpc::ServerUnaryReactor* RunUnary(const UnaryCall& call, UnaryHandler handler) {
  RequestTag request{.id = call.context->calls->running_calls.RequestIdOf(*call.call)};
  const RequestScope scope(request);
  const uint64_t flow =
      std::hash<std::string>()(PeerOf(*call.call)) | 1;  // one per connection, never 0
  absl::StatusOr<HandlerContext*> admitted = Admit(call.context, *call.call, call.rpc);
  if (admitted.ok()) request.project = (*admitted)->project;
  return StartReactor<UnaryReactor>(call, std::move(admitted), flow, std::move(handler));
}

}  // namespace pleat
