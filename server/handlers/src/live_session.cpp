#include <grpcpp/server_context.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "grpc_status.h"
#include "pleat/base/status.h"
#include "pleat/service/live_queue.h"
#include "pleat/wire/skeleton_messages.h"
#include "pleat/wire/stream_messages.h"
#include "run_unary.h"
#include "session_messages.h"
#include "stream_handlers.h"

namespace pleat {
namespace {

// Reads, computes and writes at the same time, each at most once: one message of each kind is in
// memory, and what the queue bounds. A reply is computed only when the one before has been handed
// to the transport, so a client that does not read stops its own session and nobody else's.
class LiveReactor final
    : public grpc::ServerBidiReactor<v1::LiveSessionRequest, v1::LiveSessionResponse>,
      public Drainable {
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
      return queue_->Acknowledge(request_.acknowledgement().frames_received());
    }
    if (request_.part_case() != v1::LiveSessionRequest::kPose) {
      return absl::InvalidArgumentError(
          "after the start, every message of a session is a pose or an acknowledgement");
    }
    PLEAT_RETURN_IF_ERROR(queue_->Acknowledge(request_.pose().frames_received()));
    queue_->Push(FromProto(request_.pose()), std::chrono::steady_clock::now());
    return absl::OkStatus();
  }

  bool HasWork() const {
    if (stage_ != Stage::kOpen) return stage_ == Stage::kStarting;
    return queue_->ready() || (input_ended_ && !queue_->empty());  // no acknowledgement can come
  }
  bool WantsToRead() const {
    return stage_ == Stage::kNew || (stage_ == Stage::kOpen && queue_->HasRoom());
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
      queue_.reset();
      session_.reset();  // lets go of the model now, not when the client has read the status
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
      context_->pose_executor->Post([this] { Work(); });
    }
  }

  // On the executor. Nothing else touches session_ and response_ meanwhile.
  void Work() {
    std::optional<LiveTurn> turn;
    bool ended;
    {
      std::lock_guard lock(mutex_);
      ended = Ended();
      if (!ended && stage_ == Stage::kOpen) turn = queue_->Take();
    }
    absl::Status status;
    if (!ended) {
      status = CallGuarded([&] {
        response_.Clear();
        return turn.has_value() ? Show(*turn) : Start();
      });
    }
    std::unique_lock lock(mutex_);
    working_ = false;
    Keep(std::move(status));
    if (!ended && !cancelled_ && status_.ok()) {
      writing_ = true;
      StartWrite(&response_);
    }
    Advance(std::move(lock));
  }

  absl::Status Start() {
    PLEAT_RETURN_IF_ERROR(slot_.status());
    const v1::LiveSessionRequest::Start& start = request_.start();
    PLEAT_ASSIGN_OR_RETURN(const LiveRules rules, RulesOf(start));
    PLEAT_ASSIGN_OR_RETURN(SessionRequest opening, FromProto(start.character(), start.options()));
    PLEAT_ASSIGN_OR_RETURN(
        session_, context_->service->OpenSession(opening.model_id, std::move(opening.options)));
    *response_.mutable_header() = ToProto(session_->header());
    std::lock_guard lock(mutex_);
    queue_.emplace(rules, session_->model().options().history,
                   session_->model().skeleton().num_joints());
    stage_ = Stage::kOpen;
    return absl::OkStatus();
  }

  // A pose that cannot be shown is an answer, not an error.
  absl::Status Show(const LiveTurn& turn) {
    const auto start = std::chrono::steady_clock::now();
    if (turn.keyframe) session_->RequestKeyframe();
    std::vector<const Pose*> poses;
    for (const Pose& pose : turn.poses) poses.push_back(&pose);
    absl::StatusOr<EncodedFrame> frame =
        turn.status.ok() ? session_->Show(poses) : absl::StatusOr<EncodedFrame>(turn.status);
    *response_.mutable_report() =
        ReportOf(turn, start - turn.arrived, frame.ok() ? &*frame : nullptr);
    if (frame.ok()) {
      *response_.mutable_frame() = ToProto(turn.number, *std::move(frame));
    } else {
      *response_.mutable_rejection() = RejectionOf(turn.number, frame.status());
    }
    return absl::OkStatus();
  }

  StreamSlot slot_;
  HandlerContext* context_;
  grpc::CallbackServerContext* call_;
  std::unique_ptr<PoseSession> session_;  // used by Work, and by Advance when no work is under way
  v1::LiveSessionResponse response_;      // used by Work, and while writing_

  std::mutex mutex_;  // guards all below
  v1::LiveSessionRequest request_;
  Stage stage_ = Stage::kNew;
  std::optional<LiveQueue> queue_;  // of the open session
  absl::Status status_;             // why it ends
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
