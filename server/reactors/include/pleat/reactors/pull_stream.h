// A server stream whose messages are made when the client is ready for them.
#pragma once

#include <grpcpp/support/server_callback.h>

#include <atomic>
#include <functional>
#include <memory>
#include <utility>

#include "absl/status/statusor.h"
#include "pleat/reactors/grpc_status.h"
#include "pleat/reactors/handler_context.h"
#include "pleat/reactors/run_unary.h"

namespace pleat {

// Until the call is finished exactly one thing is under way: a Produce task or a write. So nothing
// here needs a lock, memory is bounded by one message, and a slow client only delays itself.
template <typename Response>
class PullStream final : public grpc::ServerWriteReactor<Response> {
 public:
  // Fills the next message: true = there is one, false = the stream ends. Runs on `executor`.
  using Next = std::function<absl::StatusOr<bool>(Response*)>;

  PullStream(HandlerContext* context, Executor* executor, const char* rpc, Next next)
      : slot_(context), executor_(executor), rpc_(rpc), next_(std::move(next)) {
    executor_->Post([this] { Produce(); });
  }

  void OnWriteDone(bool ok) override {
    if (!ok) cancelled_ = true;
    executor_->Post([this] { Produce(); });
  }
  void OnCancel() override { cancelled_ = true; }
  void OnDone() override { delete this; }

 private:
  // `this` may be gone as soon as a write or the end has been handed over.
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
    next_ = nullptr;  // lets go of the model now, not when the client has read the status
    this->Finish(ToGrpcStatus(status));
  }

  StreamSlot slot_;
  Executor* executor_;
  const char* rpc_;
  Next next_;
  Response message_;
  bool started_ = false;
  std::atomic<bool> cancelled_ = false;
};

}  // namespace pleat
