#include <grpcpp/server_context.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "pleat/base/status.h"
#include "pleat/handlers/stream_handlers.h"
#include "pleat/local/live_queue.h"
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
      private PoseWork {
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
      if (stage_ == Stage::kOpen) {
        context_->batcher->Submit(&session_->model(), this);
      } else {
        context_->pose_executor->Post(
            [this] { Answered(CallGuarded([this] { return Start(); })); });
      }
    }
  }

  // From here on to Answered on the executor. Nothing else touches session_, turn_ and response_.
  bool Prepare(PoseQuery* query) override {
    {
      std::lock_guard lock(mutex_);
      has_turn_ = !Ended();
      if (has_turn_) queue_->Take(&turn_);
    }
    start_ = std::chrono::steady_clock::now();
    if (!has_turn_ || !turn_.status.ok()) return false;
    poses_.clear();
    for (const Pose& pose : turn_.poses) poses_.push_back(&pose);
    *query = session_->QueryOf(&poses_);
    return true;
  }
  PoseEvaluator& evaluator() override { return session_->evaluator(); }
  void Evaluated(const PoseQuery* query, double evaluate_us, int num_together) override {
    if (!has_turn_) return Answered(absl::CancelledError("the session has ended"));
    Answered(CallGuarded([&] {
      Show(query, evaluate_us, num_together);
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
        session_, context_->service->OpenSession(opening.model_id, std::move(opening.options)));
    *response_.mutable_header() = ToProto(session_->header());
    std::lock_guard lock(mutex_);
    queue_.emplace(rules, session_->model().options().history,
                   session_->model().skeleton().num_joints());
    stage_ = Stage::kOpen;
    return absl::OkStatus();
  }

  // A pose that cannot be shown is an answer, not an error. query: null when its turn says why not.
  void Show(const PoseQuery* query, double evaluate_us, int num_together) {
    response_.Clear();
    if (turn_.keyframe) session_->RequestKeyframe();
    const absl::Status status =
        query != nullptr ? session_->Encode(*query, evaluate_us, &frame_) : turn_.status;
    *response_.mutable_report() =
        ReportOf(turn_, start_ - turn_.arrived, status.ok() ? &frame_ : nullptr, num_together);
    if (status.ok()) {
      *response_.mutable_frame() = ToProto(turn_.number, std::move(frame_));
    } else {
      *response_.mutable_rejection() = RejectionOf(turn_.number, status);
    }
  }

  StreamSlot slot_;
  HandlerContext* context_;
  grpc::CallbackServerContext* call_;
  // Used while working_, by Advance when nothing is under way; response_ also while writing_.
  std::unique_ptr<PoseSession> session_;
  v1::LiveSessionResponse response_;
  LiveTurn turn_;
  bool has_turn_ = false;
  EncodedFrame frame_;              // its bytes become those of response_
  std::vector<const Pose*> poses_;  // of turn_
  std::chrono::steady_clock::time_point start_;

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
