#include <grpcpp/server_context.h>

#include <memory>
#include <mutex>
#include <utility>

#include "pleat/base/status.h"
#include "pleat/handlers/stream_handlers.h"
#include "pleat/reactors/grpc_status.h"
#include "pleat/reactors/run_unary.h"
#include "pleat/wire/skeleton_messages.h"
#include "pleat/wire/stream_messages.h"
#include "session_messages.h"

namespace pleat {
namespace {

// Reads, computes and writes at the same time, each at most once: one message of each kind is in
// memory, and what the queue bounds. A reply is computed only when the one before has been handed
// to the transport, so a client that does not read stops its own session and nobody else's.
class LiveReactor final
    : public grpc::ServerBidiReactor<v1::LiveSessionRequest, v1::LiveSessionResponse>,
      public Drainable,
      private LiveListener {
 public:
  LiveReactor(HandlerContext* context, grpc::CallbackServerContext* call)
      : slot_(context), context_(context), call_(call), entry_(&context->live_sessions, this) {
    Advance(std::unique_lock(mutex_));
  }

  void OnReadDone(bool ok) override {
    std::unique_lock lock(mutex_);
    reading_ = false;
    if (finished_) return;  // a message that came too late; nobody waits for it
    if (ok) {
      Keep(CallGuarded([this] { return Accept(); }));
    } else {
      input_ended_ = true;
    }
    Advance(std::move(lock));
  }
  void OnWriteDone(bool ok) override {
    std::unique_lock lock(mutex_);
    writing_ = false;
    if (!ok) cancelled_ = true;
    Advance(std::move(lock));
  }
  void OnCancel() override {
    std::unique_lock lock(mutex_);
    cancelled_ = true;
    Advance(std::move(lock));
  }
  void OnDone() override { delete this; }

  void Drain() override { Advance(std::unique_lock(mutex_)); }
  void Abandon() override {
    std::lock_guard lock(mutex_);
    if (!finished_) call_->TryCancel();
  }

 private:
  enum class Stage { kNew, kStarting, kOpen };

  void Keep(absl::Status status) {
    if (status_.ok()) status_ = std::move(status);
  }

  // Takes in request_. With the lock.
  absl::Status Accept() {
    if (stage_ == Stage::kNew) {
      if (request_.part_case() != v1::LiveSessionRequest::kStart) {
        return absl::InvalidArgumentError("the first message of a session must be its start");
      }
      stage_ = Stage::kStarting;
      return absl::OkStatus();
    }
    if (request_.part_case() == v1::LiveSessionRequest::kAcknowledgement) {
      return stream_->Acknowledge(request_.acknowledgement().frames_received());
    }
    if (request_.part_case() != v1::LiveSessionRequest::kPose) {
      return absl::InvalidArgumentError(
          "after the start, every message of a session is a pose or an acknowledgement");
    }
    PLEAT_RETURN_IF_ERROR(stream_->Acknowledge(request_.pose().frames_received()));
    stream_->Push(FromProto(request_.pose()));
    return absl::OkStatus();
  }

  bool HasWork() const {
    if (stage_ != Stage::kOpen) return stage_ == Stage::kStarting;
    return stream_->ready() || (input_ended_ && !stream_->empty());  // no acknowledgement can come
  }
  bool WantsToRead() const {
    return stage_ == Stage::kNew || (stage_ == Stage::kOpen && stream_->HasRoom());
  }
  bool Ended() const { return cancelled_ || !status_.ok() || (input_ended_ && !HasWork()); }

  // Starts what can be started. `this` may be gone when this function returns.
  void Advance(std::unique_lock<std::mutex> lock) {
    if (finished_) return;
    if (context_->draining) Keep(absl::UnavailableError("the server is shutting down"));
    if (Ended()) {
      if (working_ || writing_) return;  // they come back here
      finished_ = true;
      if (cancelled_) {
        Keep(absl::CancelledError("the client is gone"));
      } else {
        LogFailure("LiveSession", status_);
      }
      const grpc::Status status = ToGrpcStatus(status_);
      stream_.reset();  // lets go of the model now, not when the client has read the status
      lock.unlock();
      Finish(status);
      return;
    }
    if (!reading_ && !input_ended_ && WantsToRead()) {
      reading_ = true;
      StartRead(&request_);
    }
    if (!working_ && !writing_ && HasWork()) {
      working_ = true;
      if (stage_ == Stage::kOpen) {
        stream_->Answer();
      } else {
        context_->pose_executor->Post(
            [this] { Answered(CallGuarded([this] { return Start(); })); });
      }
    }
  }

  // On a thread of the service. Nothing else touches response_ until it is written.
  void OnReply(LiveReply&& reply) override {
    Answered(CallGuarded([&] {
      Fill(std::move(reply));
      return absl::OkStatus();
    }));
  }

  // Sends what is in response_, or ends. `this` may be gone when this function returns.
  void Answered(absl::Status status) {
    std::unique_lock lock(mutex_);
    working_ = false;
    Keep(std::move(status));
    if (!cancelled_ && status_.ok()) {
      writing_ = true;
      StartWrite(&response_);
    }
    Advance(std::move(lock));
  }

  absl::Status Start() {
    PLEAT_RETURN_IF_ERROR(slot_.status());
    response_.Clear();
    const v1::LiveSessionRequest::Start& start = request_.start();
    PLEAT_ASSIGN_OR_RETURN(const LiveRules rules, RulesOf(start));
    PLEAT_ASSIGN_OR_RETURN(SessionRequest opening, FromProto(start.character(), start.options()));
    PLEAT_ASSIGN_OR_RETURN(
        std::unique_ptr<PoseStream> stream,
        context_->poses->OpenStream(opening.model_id, std::move(opening.options), rules, this));
    *response_.mutable_header() = ToProto(stream->header());
    std::lock_guard lock(mutex_);
    stream_ = std::move(stream);
    stage_ = Stage::kOpen;
    return absl::OkStatus();
  }

  // A pose that cannot be shown is an answer, not an error.
  void Fill(LiveReply&& reply) {
    response_.Clear();
    *response_.mutable_report() = ReportOf(reply);
    if (reply.frame.ok()) {
      *response_.mutable_frame() = ToProto(reply.number, *std::move(reply.frame));
    } else {
      *response_.mutable_rejection() = RejectionOf(reply.number, reply.frame.status());
    }
  }

  StreamSlot slot_;
  HandlerContext* context_;
  grpc::CallbackServerContext* call_;
  v1::LiveSessionResponse response_;  // used while working_ or writing_

  std::mutex mutex_;  // guards all below
  v1::LiveSessionRequest request_;
  Stage stage_ = Stage::kNew;
  std::unique_ptr<PoseStream> stream_;  // of the open session
  absl::Status status_;                 // why it ends
  bool reading_ = false, writing_ = false, working_ = false;
  bool input_ended_ = false, cancelled_ = false, finished_ = false;
  LiveRegistry::Entry entry_;
};

}  // namespace

grpc::ServerBidiReactor<v1::LiveSessionRequest, v1::LiveSessionResponse>* LiveSession(
    HandlerContext* context, grpc::CallbackServerContext* call) {
  return new LiveReactor(context, call);
}

}  // namespace pleat
