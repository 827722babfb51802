// A server stream whose messages are made when the client is ready for them.
#pragma once

#include <grpcpp/support/server_callback.h>

#include <atomic>
#include <functional>
#include <memory>
#include <utility>

#include "absl/status/statusor.h"
#include "pleat/reactors/call_reactor.h"
#include "pleat/reactors/grpc_status.h"
#include "pleat/reactors/handler_context.h"
#include "pleat/reactors/run_unary.h"
#include "pleat/service/limits.h"

namespace pleat {

// The message that is being made and what of it is on its way: pieces of files. Frames are counted
// by the sessions that make them.
inline constexpr uint64_t kPullStreamBytes = 2 * kDownloadPieceBytes;

// Sequential (call_reactor.h): until the call is finished, either a Produce task or a write is
// under way. So nothing here needs a lock, memory is bounded by one message, and a slow client only
// delays itself.
template <typename Response>
class PullStream final : public CallReactor<grpc::ServerWriteReactor<Response>> {
 public:
  // Fills the next message. True: there is one; false: the stream ends. Runs on `executor`.
  using Next = std::function<absl::StatusOr<bool>(Response*)>;

  // kind: of the turns in which the messages are made.
  PullStream(HandlerContext* context, Executor* executor, const char* rpc, Next next,
             TurnKind kind = TurnKind::kInteractive)
      : CallReactor<grpc::ServerWriteReactor<Response>>(context),
        slot_(context, kStreamBytes + kPullStreamBytes),
        executor_(executor),
        rpc_(rpc),
        next_(std::move(next)),
        kind_(kind) {}

  void Start() { Schedule(); }
  void OnWriteDone(bool ok) override {
    if (!ok) cancelled_ = true;
    Schedule();
  }
  void OnCancel() override { cancelled_ = true; }

 private:
  void Schedule() {
    this->Post(
        executor_, [this] { Produce(); }, /*flow=*/0, kind_);
  }

  // Starts the next write or ends the call, as its last act.
  void Produce() {
    bool more = false;
    absl::Status status;
    if (cancelled_) {
      status = absl::CancelledError("the client gave up");
    } else if (!started_) {  // what has started may end while the server drains
      status = slot_.status();
      started_ = true;
    }
    if (status.ok()) {
      status = CallGuarded([&] {
        message_.Clear();
        absl::StatusOr<bool> result = next_(&message_);
        if (result.ok()) more = *result;
        return result.status();
      });
    }
    if (status.ok() && more) {
      this->StartWrite(&message_);
      return;
    }
    if (!cancelled_) LogFailure(rpc_, status);
    next_ = nullptr;  // lets go of what it holds, such as a model
    this->Finish(ToGrpcStatus(status));
  }

  StreamSlot slot_;
  Executor* executor_;
  const char* rpc_;
  Next next_;
  const TurnKind kind_;
  Response message_;
  bool started_ = false;
  std::atomic<bool> cancelled_ = false;
};

}  // namespace pleat
